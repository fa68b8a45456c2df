// Every formula of the page is typeset in place. A browser without scripts shows its LaTeX.
for (const element of document.querySelectorAll(".math")) {
  katex.render(element.textContent, element, { displayMode: true, throwOnError: false, output: "html", strict: "warn" });
}

// On paper nothing scrolls and nothing is folded: formulas wider than a page become smaller.
const PAPER = 660; // px, of the 180 mm between the margins
addEventListener("beforeprint", () => {
  for (const folded of document.querySelectorAll("details")) folded.open = true;
  for (const formula of document.querySelectorAll(".math > .katex-display")) {
    const glyphs = document.createRange();
    glyphs.selectNodeContents(formula.querySelector(".katex-html") ?? formula);
    formula.style.setProperty("--fit", Math.min(1, PAPER / glyphs.getBoundingClientRect().width));
  }
});
