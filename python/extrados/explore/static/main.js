// The page on its own: a socket to the server that served it.
import { socketTransport } from "./transport.js";
import { load } from "./words.js";

await load(); // before the modules whose words it gives
const { mount } = await import("./app.js");

const address = new URL("live", location.href);
address.protocol = "ws:";
const root = document.getElementById("extrados");
address.hash = "";
const app = mount(root, socketTransport(address.href), new URL("film", location.href).href);
window.extrados = app;
/** The deck of the address is opened once, and leaves the address. */
const shared = () => { const link = location.hash; if (!link) return; history.replaceState(null, "", location.pathname); app.openLink(link); };
let greeted = false;
app.on("text", () => { if (!greeted) { greeted = true; shared(); } });
addEventListener("hashchange", shared);
