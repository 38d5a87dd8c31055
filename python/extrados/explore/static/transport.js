// Transport of messages: JSON to the session, frames of words and arrays back (see frames.py).

const TYPES = { f: Float32Array, d: Float64Array, i: Int32Array, b: Uint8Array };

/** Words and arrays of a frame; an array is {data, shape}. */
export function unpack(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const words = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const arrays = {};
  for (const [name, [sort, shape, offset]] of Object.entries(words.arrays)) {
    const count = shape.reduce((a, b) => a * b, 1);
    const data = new TYPES[sort](buffer, 4 + length + offset, count);
    data.shape = shape;
    arrays[name] = data;
  }
  return { words, arrays };
}

/** A socket that reconnects: `onstate` receives "open", "lost" or "moved", `onreply` the replies. A server that was begun anew has
    another address, which this page cannot know: it refuses the old one. */
export function socketTransport(address) {
  const transport = { onstate: () => {}, onreply: () => {}, send, close, open: false };
  let socket = null, tries = 0, closed = false;
  connect();

  function connect() {
    socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => { tries = 0; transport.open = true; transport.onstate("open"); };
    socket.onmessage = (event) => transport.onreply(unpack(event.data));
    socket.onclose = async (event) => {
      transport.open = false;
      if (closed) return;
      tries += 1;
      transport.onstate("lost", tries, event.reason);
      if (tries > 1 && !event.reason && await refused()) { transport.onstate("moved"); return; }
      setTimeout(connect, Math.min(250 * 1.5 ** tries, 4000));
    };
  }
  async function refused() {
    try { return (await fetch(location.pathname, { method: "HEAD" })).status === 403; } catch { return false; }
  }
  function send(message) {
    if (socket.readyState !== WebSocket.OPEN) return false;
    socket.send(JSON.stringify(message));
    return true;
  }
  function close() { closed = true; socket.close(); }
  return transport;
}
