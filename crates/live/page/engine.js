// The main thread's side of a worker with the module. It sends one request after the other, each with a time limit. A worker that
// exceeds its limit is terminated, and the next request starts a new one.

class Engine {
  // `module.packed` is a promise of the bytes of the module; all workers share the module that the first of them compiles. `script` is
  // the text of the worker.
  constructor(module, script) {
    this.module = module;
    this.url = URL.createObjectURL(new Blob([script], { type: 'text/javascript' }));
    this.worker = null;
    this.last = Promise.resolve();
    this.count = 0;
  }

  // The answer to a request as { answer, numbers, ms }. The promise is rejected with an error whose message is shown to the user.
  ask(request, seconds) {
    return this.queue(async () => {
      await this.ready();
      const begun = performance.now();
      const { text, numbers } = await this.post({ request: JSON.stringify(request) }, [], seconds);
      return { answer: JSON.parse(text), numbers, ms: performance.now() - begun };
    });
  }

  // The text of a scene in a link; this needs no module.
  inflate(packed, most, seconds) {
    return this.queue(async () => {
      if (!this.worker) this.worker = new Worker(this.url);
      return (await this.post({ link: packed, most }, [], seconds)).text;
    });
  }

  // Terminates the worker if a request is running.
  stop() {
    if (this.reject) this.reject(new Error('stopped'));
  }

  queue(task) {
    const done = this.last.then(task);
    this.last = done.catch(() => {});
    return done;
  }

  async ready() {
    if (this.worker && this.started) return;
    const { module } = this;
    const own = module.compiled ? { compiled: module.compiled } : { packed: await module.packed };
    if (!this.worker) this.worker = new Worker(this.url);
    ({ compiled: module.compiled } = await this.post({ module: own }, [], 60));
    this.started = true;
  }

  post(message, moved, seconds) {
    const id = ++this.count;
    return new Promise((resolve, reject) => {
      const end = (act) => {
        clearTimeout(clock);
        this.reject = null;
        act();
      };
      const lose = (error) => end(() => {
        this.worker.terminate();
        this.worker = null;
        this.started = false;
        reject(error);
      });
      const clock = setTimeout(() => lose(new Error(`not done after ${seconds} s`)), 1000 * seconds);
      this.reject = lose;
      this.worker.onmessage = ({ data }) => {
        if (data.id !== id) return;
        end(() => (data.failure ? reject(new Error(data.failure)) : resolve(data)));
      };
      this.worker.onerror = (event) => lose(new Error(event.message || 'the worker failed'));
      this.worker.postMessage({ id, ...message }, moved);
    });
  }
}

// Decodes Base64.
const carried = (text) => Uint8Array.from(atob(text.trim()), (c) => c.charCodeAt(0));
