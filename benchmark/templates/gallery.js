"use strict";
// Layers and lines of the gallery's cards. Without this script the picture is shown with all lines, the layers stacked below.
(() => {
  const enhance = (card) => {
    const image = card.querySelector(".g-image"), tools = card.querySelector(".g-tools"), stack = card.querySelector(".g-layers");
    const layers = [...stack.querySelectorAll(".g-layer")], picture = image.getAttribute("href");
    const show = (key) => {
      for (const layer of layers) {
        const on = layer.dataset.layer === key, hidden = layer.querySelector("img");
        layer.classList.toggle("g-on", on);
        if (on) image.setAttribute("href", hidden ? hidden.getAttribute("src") : picture);
      }
    };
    tools.addEventListener("change", (event) => {
      const input = event.target;
      if (input.type === "radio") show(input.value);
      else for (const shape of card.querySelectorAll(".g-shape")) {
        if (shape.dataset.kind === input.value) shape.toggleAttribute("hidden", !input.checked);
      }
    });
    for (const input of tools.querySelectorAll("input")) input.checked = input.defaultChecked; // browsers keep them over a reload
    show("picture");
    stack.open = true;
    stack.classList.add("g-ready");
    tools.hidden = false;
  };
  for (const card of document.querySelectorAll(".g-card:not(.g-scan)")) enhance(card);
})();
