// The worker: the module, one instance of it, and one request at a time. After a failure in the module the next request gets a new
// instance.

let module = null;
let instance = null;

// Starts an instance of the packed module, or of a module that another worker has compiled.
async function start({ packed, compiled }) {
  module = compiled || await WebAssembly.compile(unpackLzma(packed));
  instance = await WebAssembly.instantiate(module, {});
}

// Passes the text of a request to the module and returns text and numbers. Every call may move the memory, so views on it are created
// after each call, and results are copied.
function respond(request) {
  const { memory, room, respond: answer, text_bytes: textBytes, numbers, number_count: numberCount } = instance.exports;
  const bytes = new TextEncoder().encode(request);
  const at = room(bytes.length);
  new Uint8Array(memory.buffer, at, bytes.length).set(bytes);
  const text = answer();
  const decoded = new TextDecoder().decode(new Uint8Array(memory.buffer, text, textBytes()));
  const values = new Float64Array(memory.buffer, numbers(), numberCount()).slice();
  return { text: decoded, numbers: values };
}

// Unpacks the text of a shared link; longer texts than `most` bytes are an error.
async function inflate(bytes, most) {
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw')).getReader();
  const parts = [];
  let size = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    size += value.length;
    if (size > most) throw new Error(`the scene of this link is longer than ${most} bytes`);
    parts.push(value);
  }
  return new Blob(parts).text();
}

self.onmessage = async ({ data }) => {
  try {
    if (data.module) {
      await start(data.module);
      self.postMessage({ id: data.id, compiled: module });
    } else if (data.link) {
      self.postMessage({ id: data.id, text: await inflate(data.link, data.most) });
    } else {
      if (!instance) instance = await WebAssembly.instantiate(module, {});
      const answer = respond(data.request);
      self.postMessage({ id: data.id, ...answer }, [answer.numbers.buffer]);
    }
  } catch (error) {
    if (error instanceof WebAssembly.RuntimeError || error instanceof RangeError) instance = null;
    self.postMessage({ id: data.id, failure: String(error.message || error) });
  }
};
