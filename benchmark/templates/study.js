"use strict";
// One point at a time: chosen from the list, or by its mark in a map. Without this every point is shown.
(() => {
  const list = document.querySelector("#points-list");
  if (!list) return;
  const cards = [...document.querySelectorAll(".card[id]")];

  function show(name, jump) {
    const known = cards.some((card) => card.id === name);
    for (const card of cards) card.hidden = known ? card.id !== name : name !== "all";
    document.querySelector(".cards").classList.toggle("one", known);
    list.value = known ? name : "all";
    if (jump && known) document.getElementById(name).scrollIntoView({ block: "center" });
  }

  list.closest(".chooser").hidden = false;
  list.addEventListener("change", () => {
    show(list.value, false);
    history.replaceState(null, "", list.value === "all" ? "#points" : `#${list.value}`);
  });
  window.addEventListener("hashchange", () => { if (location.hash.startsWith("#point-")) show(location.hash.slice(1), true); });
  show(location.hash.startsWith("#point-") ? location.hash.slice(1) : cards[0]?.id, location.hash.startsWith("#point-"));
})();
