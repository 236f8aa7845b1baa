// Scenes from examples, files and links, and to files and links.

class SceneFiles {
  constructor(live) {
    this.live = live;
    this.examples = JSON.parse(element('live-examples').textContent);
    const choice = element('live-example');
    for (const { name, title } of this.examples) choice.append(new Option(title, name));
    choice.addEventListener('change', () => {
      const example = this.examples.find(({ name }) => name === choice.value);
      if (example) live.open(example.text);
      choice.value = '';
    });
    const file = element('live-file');
    element('live-open').addEventListener('click', () => file.click());
    file.addEventListener('change', async () => {
      if (file.files.length) live.open(await file.files[0].text());
      file.value = '';
    });
    element('live-save').addEventListener('click', () => download('scene.toml', live.editor.text));
    element('live-share').addEventListener('click', () => this.share());
    element('live-c').addEventListener('click', () => this.exportC());
    window.addEventListener('hashchange', async () => {
      const text = await this.linkedScene();
      if (text !== null) live.open(text);
    });
  }

  // That of the link; else that of the file; else the first example.
  async firstScene() {
    const linked = await this.linkedScene();
    if (linked !== null) return linked;
    return JSON.parse(element('live-scene').textContent) ?? this.examples[0].text;
  }

  // The scene of the address, which then forgets it; nothing where there is none.
  async linkedScene() {
    const packed = packedScene(location.hash);
    if (!packed) return null;
    history.replaceState(null, '', location.pathname + location.search);
    try {
      return await this.live.asked.inflate(packed, LONGEST_SCENE, LINK_LIMIT);
    } catch (error) {
      return `# The scene of the link cannot be read: ${error.message.replace(/[\r\n]/g, ' ')}\n`;
    }
  }

  async share() {
    const packed = await packScene(this.live.editor.text);
    const address = `${location.href.split('#')[0]}#scene=${packed}`;
    history.replaceState(null, '', address);
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
      this.live.failed(error);
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
