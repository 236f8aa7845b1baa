// Opens scenes from examples, files and links, and saves them to files and links. The history of the tab holds the text: it survives a
// reload, and the back button returns to the previous scene.

// Delay in ms between the last change and the update of the history, because browsers limit how often the history may change.
const KEEP_AFTER = 300;

class SceneFiles {
  constructor(live) {
    this.live = live;
    // The scene in the page file, as JSON. If `dwell view` writes the file again with another scene, texts in the history are ignored.
    this.carried = element('live-scene').textContent;
    this.waiting = null;
    this.examples = JSON.parse(element('live-examples').textContent);
    const choice = element('live-example');
    for (const { name, title } of this.examples) choice.append(new Option(title, name));
    choice.addEventListener('change', () => {
      const example = this.examples.find(({ name }) => name === choice.value);
      if (example) this.openNext(example.text);
      choice.value = '';
    });
    const file = element('live-file');
    element('live-open').addEventListener('click', () => file.click());
    file.addEventListener('change', async () => {
      const [chosen] = file.files;
      if (chosen && chosen.size > LONGEST_SCENE) live.say(`not opened: ${chosen.name} is longer than ${LONGEST_SCENE} bytes`);
      else if (chosen) this.openNext(await chosen.text());
      file.value = '';
    });
    element('live-save').addEventListener('click', () => download('scene.toml', live.editor.text));
    element('live-share').addEventListener('click', () => this.share());
    element('live-c').addEventListener('click', () => this.exportC());
    window.addEventListener('hashchange', async () => {
      if (this.kept() !== null) return;
      const text = await this.linkedScene();
      if (text !== null) live.open(text);
    });
    window.addEventListener('popstate', () => {
      clearTimeout(this.waiting);
      const text = this.kept();
      if (text !== null) live.open(text);
    });
  }

  // The text of the current history entry, or null.
  kept() {
    const { state } = history;
    return state && typeof state.scene === 'string' && state.carried === this.carried ? state.scene : null;
  }

  // Stores the text in the history after KEEP_AFTER, and removes a scene from the address.
  keep() {
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => this.keepNow(location.pathname + location.search), KEEP_AFTER);
  }

  keepNow(address) {
    clearTimeout(this.waiting);
    try {
      history.replaceState({ scene: this.live.editor.text, carried: this.carried }, '', address);
    } catch {
      // The browser rejects texts that are too long for its history; they are not stored.
    }
  }

  // Opens another scene in a new history entry.
  openNext(text) {
    this.keepNow(location.href);
    history.pushState(null, '', location.pathname + location.search);
    this.live.open(text);
  }

  // The first scene: from the history, else from the link, else from the page file, else the first example.
  async firstScene() {
    const kept = this.kept();
    if (kept !== null) return kept;
    const linked = await this.linkedScene();
    if (linked !== null) return linked;
    return JSON.parse(element('live-scene').textContent) ?? this.examples[0].text;
  }

  // The scene of the address, which is removed from the address; null if there is none.
  async linkedScene() {
    const packed = packedScene(location.hash);
    if (!packed) return null;
    clearTimeout(this.waiting);
    history.replaceState(null, '', location.pathname + location.search);
    try {
      return await this.live.asked.inflate(packed, LONGEST_SCENE, LINK_LIMIT);
    } catch (error) {
      return `# The scene of the link cannot be read: ${error.message.replace(/[\r\n]/g, ' ')}\n`;
    }
  }

  async share() {
    const { text } = this.live.editor;
    if (new Blob([text]).size > LONGEST_SCENE) return this.live.say(`no link: the scene is longer than ${LONGEST_SCENE} bytes; save it instead`);
    const address = `${location.href.split('#')[0]}#scene=${await packScene(text)}`;
    this.keepNow(address);
    try {
      await navigator.clipboard.writeText(address);
      this.live.say(`copied: a link of ${address.length} characters that holds the scene`);
    } catch {
      this.live.say('the address of this page now holds the scene');
    }
  }

  async exportC() {
    try {
      const { answer } = await this.live.asked.ask({ do: 'c', text: this.live.editor.text }, ASKED_LIMIT);
      this.live.messages(answer.messages);
      for (const [name, text] of answer.files || []) download(name, text);
      this.live.say(answer.files ? `exported: ${answer.files.map(([name]) => name).join(', ')}` : 'not exported: see the messages beside');
    } catch (error) {
      if (error.message !== 'stopped') this.live.failed(error);
    }
  }
}

function download(name, text) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([text], { type: 'text/plain' }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
