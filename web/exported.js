// An exported page, which contains its materials.
"use strict";
(async () => {
  const data = JSON.parse(document.getElementById("data").textContent), { materials } = data;
  delete data.materials;
  const shown = [...document.querySelectorAll("figure[data-material]")].map((figure) => Number(figure.dataset.material));
  if (shown.length && await viewer.start(data)) {
    document.getElementById("without").hidden = true;
    for (const index of shown)
      if (materials[index])
        viewer.set_material(index, { ...materials[index], text: document.getElementById("glsl-" + index).textContent });
  }
})();
