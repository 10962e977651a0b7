// Functions that site.py calls on the page. It runs this file on each page that it opens.
"use strict";
{
  const element_of = (id) => document.getElementById(id);
  const canvas_of = (material) => `figure[data-material='${material}'] canvas`;
  const boxes_of = (selector) => [...document.querySelectorAll(selector)].map((element) => element.getBoundingClientRect());

  const tasks = []; // durations of tasks during which the page does not respond [ms]
  new PerformanceObserver((list) => {
    for (const entry of list.getEntries()) tasks.push(entry.duration);
  }).observe({ type: "longtask", buffered: true });
  document.body.append(Object.assign(document.createElement("input"), { type: "file", id: "given" }));

  window.site = {
    // Drops the file that the input `given` holds.
    drop() {
      const transfer = new DataTransfer();
      transfer.items.add(element_of("given").files[0]);
      document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true, cancelable: true }));
    },
    // The file that is shown, what the page does, and its texts.
    state() {
      const { file, fitted, edited, busy } = app.state(), is_shown = (id) => !element_of(id).hidden, text = (id) => element_of(id).textContent;
      return { name: fitted && file.name, bytes: fitted?.bytes ?? null, memory: fitted?.memory ?? 0, is_edited: edited !== null, is_busy: busy > 0,
        is_editable: is_shown("editing"), is_fitting: is_shown("working"), is_saving: is_shown("writing"), heading: text("name"),
        ...Object.fromEntries(["about", "edit_status", "failure", "saved", "verdict"].map((id) => [id, text(id)])) };
    },
    // The names of the materials whose pictures are shown.
    materials: () => [...document.querySelectorAll("figure:not([hidden])")].map((figure) => figure.dataset.material),
    // The length of the longest task since the last call [ms].
    longest_task: () => Math.max(0, ...tasks.splice(0)),
    // The bytes of the file that the page would save.
    saved_bytes: async (format, name) => [...new Uint8Array(await (await app.save_as(format, name)).arrayBuffer())],
    // The hash of that file, or the error.
    async saved_hash(format, name) {
      try {
        const content = await app.save_as(format, name), digest = await crypto.subtle.digest("SHA-256", await content.arrayBuffer());
        return [...new Uint8Array(digest)].map((byte) => byte.toString(16).padStart(2, "0")).join("");
      } catch (error) {
        return "error " + error.message;
      }
    },
    // The top and the bottom of the sliders, the buttons that save, a picture and these other elements of it [pixels].
    extent(material, others) {
      element_of("edit_roughen").scrollIntoView({ block: "center" });
      const boxes = boxes_of(`#editing input, #saving .main, ${canvas_of(material)}${others}`);
      return [Math.min(...boxes.map((box) => box.top)), Math.max(...boxes.map((box) => box.bottom))];
    },
    // Sets a light or a shape of the pictures, a slider of the edits, or the number of lobes.
    set_control(name, value) {
      const input = document.querySelector(".controls").elements[name] ?? document.querySelector(`#edit_${name}, #${name}`);
      input.value = value;
      for (const kind of ["input", "change"]) input.dispatchEvent(new Event(kind, { bubbles: true }));
    },
    // The brightness of pixels in the middle of a picture, and whether all of them were drawn.
    pixels(material) {
      const copy = Object.assign(document.createElement("canvas"), { width: 80, height: 60 }).getContext("2d"), numbers = [];
      copy.drawImage(document.querySelector(canvas_of(material)), 0, 0, 80, 60);
      const bytes = copy.getImageData(25, 15, 30, 30).data;
      for (let i = 0; i < bytes.length; i += 4) numbers.push((bytes[i] + bytes[i + 1] + bytes[i + 2]) / 765);
      return [numbers, bytes.every((byte, i) => i % 4 < 3 || byte === 255)];
    },
    // What an edit may lose or move: material, sliders, address, and the boxes of pictures, sliders and buttons.
    edited_state() {
      const boxes = boxes_of("figure:not([hidden]) canvas, #editing input, #saving .main"), { file, edited } = app.state();
      return { address: location.hash, name: file.name, edited: edited?.bytes, hue: element_of("edit_hue").value,
        boxes: boxes.map((box) => [box.x, box.y - boxes[0].y, box.width, box.height].map(Math.round)) };
    },
  };
}
