"use strict";
// What the page does beyond showing everything: another theme, sorted tables, one method at a time. Nothing here is needed to read it.
(() => {
  const root = document.documentElement;

  function addThemeButton() {
    const system = window.matchMedia("(prefers-color-scheme: dark)");
    const button = document.createElement("button");
    const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : system.matches);
    const label = () => { button.textContent = isDark() ? "Light theme" : "Dark theme"; };
    button.type = "button";
    button.className = "theme";
    button.addEventListener("click", () => {
      root.dataset.theme = isDark() ? "light" : "dark";
      try { localStorage.setItem("hardlight-theme", root.dataset.theme); } catch { /* it lasts as long as the page */ }
      label();
    });
    system.addEventListener("change", label);
    label();
    document.querySelector(".top").append(button);
  }

  function valueOf(row, column, kind) {
    const cell = row.cells[column];
    if (kind === "text") return cell.textContent.trim().toLowerCase();
    const text = cell.dataset.value ?? "";
    return text === "" ? null : Number(text);
  }

  function compare(first, second, direction) {
    if (first === null || second === null) return (first === null) - (second === null); // missing ones last, either way
    const order = typeof first === "string" ? first.localeCompare(second) : first - second;
    return direction === "descending" ? -order : order;
  }

  function sort(table, header, says) {
    const headers = [...header.parentElement.cells];
    const opposite = { ascending: "descending", descending: "ascending" };
    const direction = opposite[header.getAttribute("aria-sort")] ?? header.dataset.best ?? "ascending";
    for (const one of headers) one.removeAttribute("aria-sort");
    header.setAttribute("aria-sort", direction);
    const [body] = table.tBodies, column = headers.indexOf(header);
    const keyed = [...body.rows].map((row) => [valueOf(row, column, header.dataset.sort), row]);
    keyed.sort(([first], [second]) => compare(first, second, direction)); // stable: equal ones keep their order
    body.append(...keyed.map(([, row]) => row));
    says.textContent = `Sorted by ${header.innerText.replace(/\s+/g, " ").trim()}, ${direction}`;
  }

  function makeSortable(table) {
    const says = document.createElement("p");
    says.className = "visually-hidden";
    says.setAttribute("role", "status");
    table.closest(".scroll").after(says);
    for (const header of table.querySelectorAll("th[data-sort]")) {
      const button = document.createElement("button");
      button.type = "button";
      button.append(...header.childNodes);
      button.addEventListener("click", () => sort(table, header, says));
      header.append(button);
    }
  }

  function showOneMethodAtATime() {
    const pages = [...document.querySelectorAll("article.method")];
    const links = [...document.querySelectorAll("#method-list a")];
    function show(chosen) {
      for (const page of pages) page.hidden = page !== chosen;
      for (const link of links) {
        if (link.hash === `#${chosen.id}`) link.setAttribute("aria-current", "page");
        else link.removeAttribute("aria-current");
      }
    }
    function follow() {
      const chosen = pages.find((page) => `#${page.id}` === location.hash);
      if (!chosen) return;
      show(chosen);
      chosen.scrollIntoView();
      chosen.querySelector("h3").focus({ preventScroll: true });
    }
    if (pages.length < 2) return;
    show(pages[0]);
    follow();
    window.addEventListener("hashchange", follow);
  }

  addThemeButton();
  document.querySelectorAll("table.sortable").forEach(makeSortable);
  showOneMethodAtATime();
})();
