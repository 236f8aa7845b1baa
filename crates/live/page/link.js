// A scene in a link, compressed into the fragment of the address, which browsers do not send to a server.

const LONGEST_SCENE = 1000000;

async function packScene(text) {
  const stream = new Blob([text]).stream().pipeThrough(new CompressionStream('deflate-raw'));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  let binary = '';
  for (const byte of bytes) binary += String.fromCharCode(byte);
  return btoa(binary).replace(/\+/g, '-').replace(/\//g, '_').replace(/=+$/, '');
}

// The compressed scene of a fragment; null without a scene, empty if the scene is not valid Base64.
function packedScene(hash) {
  const match = /[#&]scene=([\w-]+)/.exec(hash);
  if (!match) return null;
  try {
    const binary = atob(match[1].replace(/-/g, '+').replace(/_/g, '/'));
    return Uint8Array.from(binary, (c) => c.charCodeAt(0));
  } catch {
    return new Uint8Array(0);
  }
}
