// Loads a module of webpack without its runtime. example_hosts.py puts the text of the bundle in place of CHUNK.
const modules = {}, loaded = {};
function load(id) {
    if (!(id in loaded)) modules[id].call((loaded[id] = { exports: {} }).exports, loaded[id], loaded[id].exports, load);
    return loaded[id].exports;
}
load.o = (object, name) => Object.hasOwn(object, name);
load.d = (exports, getters) => {
    for (const name in getters) Object.defineProperty(exports, name, { enumerable: true, configurable: true, get: getters[name] });
};
load.r = (exports) => Object.defineProperty(exports, "__esModule", { value: true });
load.n = (module) => Object.assign(() => module.default ?? module, { a: module.default ?? module });
load.g = window;
self.webpackChunk_tiledb_inc_pybabylonjs = { push: ([, more]) => Object.assign(modules, more) };
CHUNK
