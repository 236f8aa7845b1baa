// A worker with the module, from outside: one request after the other, each with a time limit. A worker that takes longer is ended,
// and the next request starts another.

class Engine {
  // `bytes` is a promise of the module; `script` is the text of the worker.
  constructor(bytes, script) {
    this.bytes = bytes;
    this.url = URL.createObjectURL(new Blob([script], { type: 'text/javascript' }));
    this.worker = null;
    this.last = Promise.resolve();
    this.count = 0;
  }

  // The answer to a request as { answer, numbers, ms }. Fails with an error whose message is for people.
  ask(request, seconds) {
    return this.queue(async () => {
      await this.ready();
      const begun = performance.now();
      const { text, numbers } = await this.post({ request: JSON.stringify(request) }, [], seconds);
      return { answer: JSON.parse(text), numbers, ms: performance.now() - begun };
    });
  }

  // The text that was packed into a link. Needs no module.
  inflate(packed, most, seconds) {
    return this.queue(async () => {
      if (!this.worker) this.worker = new Worker(this.url);
      return (await this.post({ packed, most }, [], seconds)).text;
    });
  }

  // Ends what is running, if anything is.
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
    const bytes = (await this.bytes).slice();
    if (!this.worker) this.worker = new Worker(this.url);
    await this.post({ bytes }, [bytes.buffer], 60);
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

// The bytes that an element of the page carries: gzip in Base64.
async function carried(text) {
  const binary = atob(text.trim());
  const bytes = Uint8Array.from(binary, (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
