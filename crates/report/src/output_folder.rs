//! The output folder: tested before the computation; each file is written completely or not at all, and no temporary files remain.
//!
//! Files are first written to a folder of their own below `.dwell`, then renamed to their targets. A lock shows whether
//! the command that owns such a folder still runs; the next command removes the files of a killed one. `.dwell` also records
//! which scene has written the results of a name, so that another scene of the same name does not replace them.

use crate::error::ReportError;
use crate::files::{Content, Files};
use std::fs::{self, File, TryLockError};
use std::io;
use std::panic::resume_unwind;
use std::path::{Path, PathBuf};
use std::thread;

/// Below the folder of the results.
const INTERNAL: &str = ".dwell";
/// Folders of unfinished files, one for each command that runs, and their locks.
const UNFINISHED: &str = "unfinished-";
const LOCK: &str = "lock";
/// Commands that write to one folder at the same time.
const MAX_COMMANDS: usize = 10_000;
/// Maximum number of attempts to create the folder while other commands remove it.
const MAX_ATTEMPTS: usize = 100;
/// Files that are stored at the same time.
const MAX_STORED_AT_ONCE: usize = 16;

/// A folder to which a command writes. If it is dropped before [`write`](Self::write), no files remain.
#[derive(Debug)]
pub struct OutputFolder {
    root: PathBuf,
    /// The name of the results, and the scene they are of.
    owner: Option<(String, PathBuf)>,
    unfinished: PathBuf,
    /// Held while the command runs.
    lock: Option<File>,
    /// Folders that did not exist before, outer ones first.
    created: Vec<PathBuf>,
}

fn file_error(path: &Path) -> impl FnOnce(io::Error) -> ReportError {
    let path = path.to_owned();
    move |source| ReportError::File { path, source }
}

impl OutputFolder {
    /// Creates the folder if it is missing, tests that files can be written there, and removes temporary files of killed commands.
    ///
    /// # Errors
    /// [`ReportError::File`] with the path and the system's reason.
    pub fn open(root: &Path) -> Result<Self, ReportError> {
        // Another command may remove the empty `.dwell` before a lock is created in it.
        let is_removed = |error: &ReportError| matches!(error, ReportError::File { source, .. } if source.kind() == io::ErrorKind::NotFound);
        for _ in 1..MAX_ATTEMPTS {
            match Self::open_once(root) {
                Err(error) if is_removed(&error) => {}
                opened => return opened,
            }
        }
        Self::open_once(root)
    }

    fn open_once(root: &Path) -> Result<Self, ReportError> {
        let mut folder = Self {
            root: root.to_owned(),
            owner: None,
            unfinished: root.join(INTERNAL),
            lock: None,
            created: Vec::new(),
        };
        let internal = root.join(INTERNAL);
        folder.create(&internal)?;
        remove_abandoned(&internal);
        for number in 0..MAX_COMMANDS {
            let unfinished = internal.join(format!("{UNFINISHED}{number}"));
            if let Some(lock) = locked(&unfinished.with_extension(LOCK))? {
                folder.unfinished = unfinished;
                folder.lock = Some(lock);
                fs::create_dir_all(&folder.unfinished).map_err(file_error(root))?;
                return Ok(folder);
            }
        }
        Err(file_error(root)(io::ErrorKind::ResourceBusy.into()))
    }

    /// Reserves a name for the results of a scene.
    ///
    /// # Errors
    /// [`ReportError::NameInUse`] if results of another scene, which still exists, have this name.
    pub fn reserve(&mut self, name: &str, scene: &Path) -> Result<(), ReportError> {
        let scene = fs::canonicalize(scene).unwrap_or_else(|_| scene.to_owned());
        if let Ok(other) = fs::read_to_string(self.owner_file(name)) {
            let other = PathBuf::from(other.trim_end());
            if other != scene && other.is_file() {
                let (name, folder) = (name.to_owned(), self.root.clone());
                return Err(ReportError::NameInUse {
                    name,
                    folder,
                    other,
                });
            }
        }
        self.owner = Some((name.to_owned(), scene));
        Ok(())
    }

    fn owner_file(&self, name: &str) -> PathBuf {
        self.root.join(INTERNAL).join(format!("{name}.scene"))
    }

    /// Writes the files, and returns their paths.
    ///
    /// All files are written and flushed to disk before the first is renamed to its target. A reader therefore never
    /// reads a partial file, and if the disk is full or a target is a folder, nothing changes. Only if a
    /// rename fails after that, the files renamed before are new.
    ///
    /// # Errors
    /// [`ReportError::File`] with the path and the system's reason.
    pub fn write(mut self, files: &Files) -> Result<Vec<PathBuf>, ReportError> {
        let mut staged = Vec::new();
        let owner_file = self.owner.take().map(|(name, scene)| {
            let text = format!("{}\n", scene.display());
            (self.owner_file(&name), Content::Bytes(text.into_bytes()))
        });
        let owner = owner_file.iter().map(|(path, text)| (path.clone(), text));
        let files = files
            .contents()
            .map(|(path, content)| (self.root.join(path), content));
        for (target, content) in files.chain(owner).collect::<Vec<_>>() {
            // Renaming onto a folder would fail too, but only after others have been renamed.
            if target.is_dir() {
                return Err(file_error(&target)(io::ErrorKind::IsADirectory.into()));
            }
            if let Content::Kept(bytes) = content
                && target.exists()
            {
                if fs::read(&target).map_err(file_error(&target))? == *bytes {
                    continue;
                }
                return Err(file_error(&target)(io::ErrorKind::AlreadyExists.into()));
            }
            let Some(parent) = target.parent() else {
                return Err(file_error(&target)(io::ErrorKind::InvalidFilename.into()));
            };
            self.create(parent)?;
            let temporary = self.unfinished.join(staged.len().to_string());
            staged.push((temporary, target, content));
        }
        store_all(&staged)?;
        let mut written = Vec::with_capacity(staged.len());
        for (temporary, target, _) in staged {
            fs::rename(temporary, &target).map_err(file_error(&target))?;
            written.push(target);
        }
        self.created.clear();
        written.retain(|path| !path.starts_with(self.root.join(INTERNAL)));
        Ok(written)
    }

    /// Makes a folder and those above it, and keeps which are new.
    fn create(&mut self, folder: &Path) -> Result<(), ReportError> {
        let is_missing = |f: &&Path| !f.as_os_str().is_empty() && !f.exists();
        let missing: Vec<&Path> = folder.ancestors().take_while(is_missing).collect();
        for folder in missing.into_iter().rev() {
            match fs::create_dir(folder) {
                Ok(()) => self.created.push(folder.to_owned()),
                // Another command was faster.
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists && folder.is_dir() => {}
                Err(e) => return Err(file_error(folder)(e)),
            }
        }
        if folder.as_os_str().is_empty() || folder.is_dir() {
            Ok(())
        } else {
            Err(file_error(folder)(io::ErrorKind::NotADirectory.into()))
        }
    }
}

/// Stores files under their temporary names, several at a time, because the system flushes waiting files together.
fn store_all(staged: &[(PathBuf, PathBuf, &Content)]) -> Result<(), ReportError> {
    for some in staged.chunks(MAX_STORED_AT_ONCE) {
        let stored: Vec<Result<(), ReportError>> = thread::scope(|scope| {
            let mut threads = Vec::new();
            for (temporary, target, content) in some {
                let store_one = move || store(temporary, content).map_err(file_error(target));
                threads.push(scope.spawn(store_one));
            }
            let threads = threads.into_iter().map(thread::ScopedJoinHandle::join);
            threads
                .map(|stored| stored.unwrap_or_else(|panic| resume_unwind(panic)))
                .collect()
        });
        stored.into_iter().collect::<Result<(), _>>()?;
    }
    Ok(())
}

/// Writes a file until the system has stored it.
fn store(path: &Path, content: &Content) -> io::Result<()> {
    let mut file = File::create(path)?;
    content.write(&mut file)?;
    file.sync_all()
}

/// The lock file, locked; `None` if another command holds it.
fn locked(path: &Path) -> Result<Option<File>, ReportError> {
    let file = File::create(path).map_err(file_error(path))?;
    match file.try_lock() {
        // A file removed between its creation and its lock protects nothing, and another command may have created a new one.
        Ok(()) => Ok(is_at(&file, path).then_some(file)),
        Err(TryLockError::WouldBlock) => Ok(None),
        // On a file system without locks, commands do not remove each other's files.
        Err(TryLockError::Error(_)) => Ok(Some(file)),
    }
}

/// Whether an open file is the one that a path leads to now.
fn is_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let place = |metadata: fs::Metadata| (metadata.dev(), metadata.ino());
        let places = (file.metadata().map(place), fs::metadata(path).map(place));
        matches!(places, (Ok(opened), Ok(found)) if opened == found)
    }
    #[cfg(not(unix))]
    {
        let _ = file;
        path.exists()
    }
}

/// Removes the unfinished files of commands that no longer run, if possible.
fn remove_abandoned(internal: &Path) {
    for entry in fs::read_dir(internal).into_iter().flatten().flatten() {
        let path = entry.path();
        let name = entry.file_name();
        let is_lock = path.extension().is_some_and(|extension| extension == LOCK);
        if !is_lock || !name.to_string_lossy().starts_with(UNFINISHED) {
            continue;
        }
        // The lock is held while its files are removed. By now its command may be done and another one may have the name.
        if let Ok(lock) = File::open(&path)
            && lock.try_lock().is_ok()
            && is_at(&lock, &path)
        {
            let _ = remove(&path);
        }
    }
}

/// Removes the unfinished files of a lock, then the lock.
fn remove(lock: &Path) -> io::Result<()> {
    let unfinished = lock.with_extension("");
    if unfinished.exists() {
        fs::remove_dir_all(unfinished)?;
    }
    fs::remove_file(lock)
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        // Folders in use cannot be removed, which is intended.
        if self.lock.is_some() {
            let _ = remove(&self.unfinished.with_extension(LOCK));
        }
        for folder in self.created.iter().rev() {
            let _ = fs::remove_dir(folder);
        }
        let _ = fs::remove_dir(self.root.join(INTERNAL));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU32, Ordering};

    fn write(files: &Files, folder: &Path) -> Result<Vec<PathBuf>, ReportError> {
        OutputFolder::open(folder)?.write(files)
    }

    /// A folder of its own for each test, removed at the end.
    struct TestFolder(PathBuf);

    impl TestFolder {
        fn new() -> Self {
            static COUNT: AtomicU32 = AtomicU32::new(0);
            let number = COUNT.fetch_add(1, Ordering::Relaxed);
            let folder =
                std::env::temp_dir().join(format!("dwell-files-{}-{number}", std::process::id()));
            fs::create_dir_all(&folder).unwrap();
            Self(folder)
        }

        /// Everything below the folder, relative to it.
        fn contents(&self) -> Vec<PathBuf> {
            let mut found = Vec::new();
            let mut open = vec![self.0.clone()];
            while let Some(folder) = open.pop() {
                for entry in fs::read_dir(folder).unwrap() {
                    let path = entry.unwrap().path();
                    if path.is_dir() {
                        open.push(path.clone());
                    }
                    found.push(path.strip_prefix(&self.0).unwrap().to_owned());
                }
            }
            found.sort();
            found
        }
    }

    impl Drop for TestFolder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn files_arrive_whole_and_alone() {
        let folder = TestFolder::new();
        fs::write(folder.0.join("a.txt"), "old").unwrap();
        let mut files = Files::new();
        files.add("a.txt", "new");
        let mut others = Files::new();
        others.add("m.csv", vec![0_u8; 100_000]);
        files.extend("tables/deep", others);
        assert_eq!(write(&files, &folder.0).unwrap().len(), 2);
        assert_eq!(fs::read(folder.0.join("a.txt")).unwrap(), b"new");
        assert_eq!(
            fs::read(folder.0.join("tables/deep/m.csv")).unwrap().len(),
            100_000
        );
        let expected = ["a.txt", "tables", "tables/deep", "tables/deep/m.csv"];
        assert_eq!(folder.contents(), expected.map(PathBuf::from));
    }

    /// As a cluster does whose workers are killed: commands begin and end in one folder while others clear up after the killed ones.
    #[test]
    fn commands_that_begin_and_end_together_keep_out_of_each_others_files() {
        let folder = TestFolder::new();
        thread::scope(|scope| {
            for writer in 0..8 {
                let root = &folder.0;
                scope.spawn(move || {
                    for round in 0..200 {
                        let mut files = Files::new();
                        let name = format!("{writer}.txt");
                        files.add(&name, format!("{writer} {round}"));
                        // What a killed command leaves: a lock that nobody holds.
                        let _ = File::create(
                            root.join(INTERNAL)
                                .join(format!("{UNFINISHED}{}.{LOCK}", round % 4)),
                        );
                        write(&files, root).unwrap();
                        let written = fs::read_to_string(root.join(&name)).unwrap();
                        assert_eq!(written, format!("{writer} {round}"));
                    }
                });
            }
        });
        let expected: Vec<PathBuf> = (0..8).map(|k| format!("{k}.txt").into()).collect();
        assert!(
            folder
                .contents()
                .iter()
                .filter(|path| !path.starts_with(INTERNAL))
                .eq(&expected)
        );
    }

    #[test]
    fn a_target_that_is_a_folder_leaves_everything_as_it_was() {
        let folder = TestFolder::new();
        fs::write(folder.0.join("a.txt"), "old").unwrap();
        fs::create_dir(folder.0.join("z.png")).unwrap();
        let before = folder.contents();
        let mut files = Files::new();
        files.add("a.txt", "new");
        files.add("fresh/b.txt", "new");
        files.add("z.png", "new");
        let error = write(&files, &folder.0).unwrap_err();
        assert!(matches!(&error, ReportError::File { path, .. } if path.ends_with("z.png")));
        assert!(
            error.to_string().contains("z.png") && error.to_string().contains("directory"),
            "{error}"
        );
        assert_eq!(folder.contents(), before);
        assert_eq!(fs::read(folder.0.join("a.txt")).unwrap(), b"old");
    }

    #[test]
    fn a_file_where_a_folder_is_needed_is_named() {
        let folder = TestFolder::new();
        fs::write(folder.0.join("tables"), "in the way").unwrap();
        let mut files = Files::new();
        files.add("a.txt", "new");
        files.add("tables/m.csv", "new");
        let error = write(&files, &folder.0).unwrap_err();
        assert!(
            matches!(&error, ReportError::File { path, .. } if path.starts_with(folder.0.join("tables")))
        );
        assert_eq!(folder.contents(), [PathBuf::from("tables")]);
    }

    #[test]
    fn a_late_refusal_still_clears_up() {
        let folder = TestFolder::new();
        let mut output = OutputFolder::open(&folder.0).unwrap();
        let scene = folder.0.join("a.toml");
        fs::write(&scene, "").unwrap();
        output.reserve("a", &scene).unwrap();
        // What keeps the name is a folder.
        fs::create_dir(folder.0.join(".dwell/a.scene")).unwrap();
        let mut files = Files::new();
        files.add("b.txt", "new");
        assert!(output.write(&files).is_err());
        fs::remove_dir_all(folder.0.join(".dwell")).unwrap();
        assert_eq!(folder.contents(), [PathBuf::from("a.toml")]);
    }

    #[test]
    fn what_a_killed_command_left_is_removed_and_what_a_running_one_writes_stays() {
        let folder = TestFolder::new();
        let internal = folder.0.join(INTERNAL);
        fs::create_dir_all(internal.join("unfinished-0")).unwrap();
        fs::write(internal.join("unfinished-0/0"), "half").unwrap();
        // Its lock is held by nobody.
        fs::write(internal.join("unfinished-0.lock"), "").unwrap();
        let running = OutputFolder::open(&folder.0).unwrap();
        assert_eq!(fs::read_dir(&running.unfinished).unwrap().count(), 0);
        fs::write(running.unfinished.join("0"), "half").unwrap();
        let mut files = Files::new();
        files.add("a.txt", "new");
        write(&files, &folder.0).unwrap();
        assert!(running.unfinished.join("0").exists());
        drop(running);
        assert_eq!(folder.contents(), [PathBuf::from("a.txt")]);
    }

    #[test]
    fn another_scene_of_the_same_name_does_not_replace_results() {
        let folder = TestFolder::new();
        let [one, two] = ["one", "two"].map(|home| folder.0.join(home).join("arm.toml"));
        for scene in [&one, &two] {
            fs::create_dir(scene.parent().unwrap()).unwrap();
            fs::write(scene, "").unwrap();
        }
        let root = folder.0.join("reports");
        let write = |scene: &Path| {
            let mut output = OutputFolder::open(&root)?;
            output.reserve("arm", scene)?;
            let mut files = Files::new();
            files.add("arm.csv", scene.display().to_string());
            output.write(&files)
        };
        assert_eq!(write(&one).unwrap(), [root.join("arm.csv")]);
        let refused = write(&two).unwrap_err();
        assert!(
            matches!(refused, ReportError::NameInUse { .. }),
            "{refused}"
        );
        assert!(refused.to_string().contains("one"), "{refused}");
        write(&one).unwrap();
        // A scene that has been moved is the same.
        fs::remove_file(&one).unwrap();
        write(&two).unwrap();
    }
}
