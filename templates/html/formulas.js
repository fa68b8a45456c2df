// Every formula of the page is typeset in place. A browser without scripts shows its LaTeX.
for (const element of document.querySelectorAll(".math")) {
  katex.render(element.textContent, element, { displayMode: true, throwOnError: false, output: "html", strict: "warn" });
}

// For printing, all details are opened, and formulas wider than the page are scaled down.
const PAPER = 660; // px: width of the text, 180 mm
addEventListener("beforeprint", () => {
  for (const folded of document.querySelectorAll("details")) folded.open = true;
  for (const formula of document.querySelectorAll(".math > .katex-display")) {
    const glyphs = document.createRange();
    glyphs.selectNodeContents(formula.querySelector(".katex-html") ?? formula);
    formula.style.setProperty("--fit", Math.min(1, PAPER / glyphs.getBoundingClientRect().width));
  }
});
