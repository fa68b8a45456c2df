// Sphinx leaves each formula as LaTeX between \( \) or \[ \]. A browser without scripts shows that.
for (const element of document.querySelectorAll(".math")) {
  const formula = element.textContent.trim().replace(/^\\[[(]|\\[\])]$/g, "");
  katex.render(formula, element, { displayMode: element.tagName === "DIV", throwOnError: false });
}
