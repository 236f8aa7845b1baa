// The live page: the scene at the side, and its results, which are updated at every change.

// Time limits in s: of results that follow every change, of results computed on request, and of unpacking a link.
const FOLLOW_LIMIT = 5;
const ASKED_LIMIT = 60;
const LINK_LIMIT = 5;

// Name, command, and whether it is computed after every change.
const COMMANDS = [
  ['Motion and forces', 'motion', true],
  ['Statics', 'statics', true],
  ['Reduced model', 'reduce', true],
  ['Simulate', 'simulate', false],
  ['Cycle', 'cycle', false],
  ['Equilibria', 'equilibria', false],
];

const element = (id) => document.getElementById(id);

class Live {
  constructor() {
    const module = { packed: moduleBytes() };
    const worker = element('live-worker').textContent;
    this.following = new Engine(module, worker);
    this.asked = new Engine(module, worker);
    this.page = DwellPage.create(element('page'), { hash: false });
    this.editor = new Editor(element('live-editor'), () => this.edited());
    this.files = new SceneFiles(this);
    this.command = 'motion';
    this.version = 0;
    // Whether no results of the opened scene have been shown yet.
    this.isOther = false;
    this.buttons = COMMANDS.map(([name, command]) => this.tab(name, command));
    document.querySelector('.live-tabs').append(...this.buttons);
    element('live-again').addEventListener('click', () => this.work(this.ask()));
  }

  tab(name, command) {
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = name;
    button.dataset.command = command;
    button.addEventListener('click', () => this.choose(command));
    return button;
  }

  async start() {
    this.choose(this.command, true);
    this.editor.open(await this.files.firstScene());
    this.edited();
    try {
      const { answer } = await this.work(this.following.ask({ do: 'schema' }, FOLLOW_LIMIT));
      this.editor.schema = new Schema(answer.schema);
    } catch (error) {
      this.say(`the module cannot be started: ${error.message}`);
    }
  }

  follows(command) { return COMMANDS.find(([, name]) => name === command)[2]; }

  choose(command, quietly) {
    // A running computation on request stops when the user leaves its tab.
    if (!this.follows(this.command)) this.asked.stop();
    this.command = command;
    for (const button of this.buttons) button.setAttribute('aria-pressed', String(button.dataset.command === command));
    this.stale(false);
    if (quietly) return;
    if (this.follows(command)) this.edited();
    else this.work(this.ask());
  }

  // Called after every change. `follow` computes one text after the other, and always continues with the newest.
  edited() {
    this.version += 1;
    this.files.keep();
    if (!this.follows(this.command)) this.stale(true);
    if (this.busy) return;
    this.busy = this.follow().finally(() => { this.busy = null; });
    this.work(this.busy);
  }

  // Marks the document as working until all tasks have ended.
  work(task) {
    this.working = (this.working || 0) + 1;
    document.body.dataset.state = 'working';
    return task.finally(() => {
      this.working -= 1;
      if (!this.working) document.body.dataset.state = 'settled';
    });
  }

  async follow() {
    for (let done = -1; done !== this.version;) {
      done = this.version;
      const { command } = this;
      const shows = this.follows(command);
      try {
        const asked = { do: 'run', command: shows ? command : 'kinematics', text: this.editor.text };
        const result = await this.following.ask(asked, FOLLOW_LIMIT);
        if (done === this.version) this.show(result, shows && command === this.command);
      } catch (error) {
        if (done === this.version) this.failed(error, FOLLOW_LIMIT);
      }
    }
  }

  // Runs a command that is computed only on request.
  async ask() {
    const { command } = this;
    const { version } = this;
    this.stale(false);
    this.asked.stop();
    this.say('computing …');
    try {
      const result = await this.asked.ask({ do: 'run', command, text: this.editor.text }, ASKED_LIMIT);
      if (command !== this.command) return;
      this.show(result, true);
      this.stale(version !== this.version);
    } catch (error) {
      if (command === this.command && error.message !== 'stopped') this.failed(error, ASKED_LIMIT);
    }
  }

  show({ answer, numbers, ms }, results) {
    this.messages(answer.messages);
    if (!results) return;
    const { page } = answer;
    if (!page) {
      this.old();
      return this.say('not computed: see the messages beside');
    }
    document.body.classList.remove('live-old', 'live-none');
    const begun = performance.now();
    this.page.show(page, numbers, this.isOther);
    this.isOther = false;
    this.work(this.page.settled());
    document.title = `${page.title} – Dwell`;
    const drawn = performance.now() - begun;
    this.say(`computed in ${ms.toFixed(1)} ms, drawn in ${drawn.toFixed(1)} ms`);
  }

  failed(error) {
    this.old();
    this.messages([{ severity: 'error', message: `this scene could not be computed here: ${error.message}`, help: 'the command line may', labels: [] }]);
    this.say('not computed');
  }

  // Marks the shown results as outdated: they are dimmed and cannot be saved. Results of a previously opened scene are hidden.
  old() {
    document.body.classList.add('live-old');
    document.body.classList.toggle('live-none', this.isOther);
    if (this.isOther) document.title = 'Dwell';
  }

  messages(messages) {
    this.editor.show(messages);
    element('live-messages').replaceChildren(...messages.map((message) => this.message(message)));
  }

  message(message) {
    const item = document.createElement('li');
    item.className = message.severity;
    const text = document.createElement('b');
    text.textContent = message.message;
    item.append(text);
    for (const label of message.labels) {
      const place = document.createElement('button');
      place.type = 'button';
      place.textContent = `line ${label.line}${label.remark ? `: ${label.remark}` : ''}`;
      place.addEventListener('click', () => this.editor.select(label));
      item.append(place);
    }
    if (message.help) {
      const help = document.createElement('span');
      help.textContent = message.help;
      item.append(help);
    }
    return item;
  }

  stale(is) { element('live-stale').hidden = !is; }

  say(text) { element('live-status').textContent = text; }

  open(text) {
    this.isOther = true;
    this.editor.open(text);
    this.edited();
    if (!this.follows(this.command)) this.choose('motion');
  }
}

// The packed module: from an element of the page, or, on a server, from a file beside it.
async function moduleBytes() {
  const { textContent, dataset } = element('live-module');
  if (!dataset.file) return carried(textContent);
  const response = await fetch(dataset.file);
  if (!response.ok) throw new Error(`${dataset.file}: ${response.status}`);
  return new Uint8Array(await response.arrayBuffer());
}

const live = new Live();
live.start();
