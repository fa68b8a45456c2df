// Every formula of the page is typeset in place. A browser without scripts shows its LaTeX.
for (const element of document.querySelectorAll(".math")) {
  katex.render(element.textContent, element, { displayMode: true, throwOnError: false, output: "html", strict: "warn" });
}
