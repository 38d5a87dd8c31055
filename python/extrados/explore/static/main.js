// The page on its own: a socket to the server that served it.
import { mount } from "./app.js";
import { socketTransport } from "./transport.js";

const address = new URL("live", location.href);
address.protocol = "ws:";
const root = document.getElementById("extrados");
window.extrados = mount(root, socketTransport(address.href), new URL("film", location.href).href);
