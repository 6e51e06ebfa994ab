"use strict";
// Before anything is drawn: the theme that was chosen last. Where the page may not store anything, the system's.
(() => {
  try {
    const stored = localStorage.getItem("hardlight-theme");
    if (stored === "light" || stored === "dark") document.documentElement.dataset.theme = stored;
  } catch { /* no storage for this page */ }
})();
