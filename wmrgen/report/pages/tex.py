"""Write the report as LaTeX, for theses and papers: the same text and formulas as report.md.

The document is for lualatex or xelatex, because its sentences have Greek letters. It uses a figure as PDF if there is
one, else as SVG if the package svg is installed, else it names the file, so that it compiles in any case.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import PurePosixPath
from typing import Any

from wmrgen.report.pages.document import tokens

Token = Any  # of markdown-it
_LINE = 100  # letters of a table on a line of 170 mm, with the spaces between its columns
_WORDS = 24  # letters: longer cells are texts, which may be broken
_TALL = 25  # rows: a higher table may continue on the next page
_HEAD = r"""\documentclass[a4paper,10pt]{article}
% For lualatex or xelatex, with the fonts DejaVu (Debian: fonts-dejavu-core).
% Figures: convert the .svg files next to this file to PDF, for example by
%   for f in *.svg; do rsvg-convert -f pdf -o ${f%.svg}.pdf $f; done
% Without these, the package svg converts them if you run lualatex --shell-escape and have Inkscape.
\usepackage[margin=20mm]{geometry}
\usepackage{fontspec,amsmath,graphicx,xcolor,array,longtable}
\usepackage[hidelinks]{hyperref}
\newcommand\named[1]{\fbox{\texttt{\detokenize{#1}.svg}}}
\newcommand\converted[1]{\includesvg[width=0.48\linewidth]{#1}}
\IfFileExists{svg.sty}{\usepackage{svg}\let\named\converted}{}
\newcommand\drawing[1]{\IfFileExists{#1.pdf}%
  {\includegraphics[width=0.48\linewidth,height=0.4\textheight,keepaspectratio]{#1.pdf}}%
  {\named{#1}}}
\setmainfont{DejaVu Serif}
\setmonofont{DejaVu Sans Mono}
\setlength\parindent{0pt}
\setlength\extrarowheight{2pt}
\setcounter{LTchunksize}{1000} % rows: column widths are right in the first run
\setlength\parskip{4pt}
\newcommand\fitted[1]{\setbox0\hbox{$\displaystyle#1$}%
  \ifdim\wd0>\linewidth\resizebox{\linewidth}{!}{\box0}\else\box0\fi}
\newenvironment{widetable}{\par\setbox0\hbox\bgroup\footnotesize\renewcommand\arraystretch{1.2}}%
  {\egroup\noindent\ifdim\wd0>\linewidth\resizebox{\linewidth}{!}{\box0}\else\box0\fi\par}
\newsavebox\shadedbox
\newenvironment{shaded}{\begin{lrbox}{\shadedbox}\begin{minipage}{\dimexpr\linewidth-2\fboxsep}\small\raggedright}%
  {\end{minipage}\end{lrbox}\par\noindent\colorbox{black!7}{\usebox\shadedbox}\par}
\sloppy
\begin{document}
"""
_ESCAPED = {
    "\\": r"\textbackslash{}", "{": r"\{", "}": r"\}", "$": r"\$", "&": r"\&", "#": r"\#", "%": r"\%", "_": r"\_",
    "^": r"\textasciicircum{}", "~": r"\textasciitilde{}", "<": r"\textless{}", ">": r"\textgreater{}",
}  # fmt: skip
_AROUND = {
    "strong_open": r"\textbf{", "strong_close": "}", "em_open": r"\emph{", "em_close": "}", "softbreak": "\n",
    "hardbreak": "\\\\\n", "paragraph_open": "", "bullet_list_open": "\\begin{itemize}\n",
    "bullet_list_close": "\\end{itemize}\n\n", "ordered_list_open": "\\begin{enumerate}\n",
    "ordered_list_close": "\\end{enumerate}\n\n", "list_item_open": r"\item ", "list_item_close": "",
    "blockquote_open": "\\begin{shaded}\n", "blockquote_close": "\\end{shaded}\n\n",
    "hr": "\\medskip\\hrule\\medskip\n\n", "thead_open": "", "tbody_open": "",
    "tbody_close": "", "tr_open": "", "th_close": "", "td_close": "", "link_close": "}",
    "heading_close": "}\n\n",
}  # fmt: skip
_RAW = {
    "<sub>": r"\textsubscript{",
    "</sub>": "}",
    "<sup>": r"\textsuperscript{",
    "</sup>": "}",
    "<br>": "\\\\\n",
}
_HEADINGS = {"h1": r"\section*{", "h2": r"\subsection*{", "h3": r"\subsubsection*{"}


def tex(*pages: str) -> str:
    """Return the LaTeX document of pages of Markdown, each of which begins a page of its own."""
    bodies = ["".join(_blocks(tokens(page))).rstrip() + "\n" for page in pages]
    return _HEAD + "\n" + "\\clearpage\n".join(bodies) + "\\end{document}\n"


def escaped(text: str) -> str:
    """Return text in which no letter is LaTeX."""
    return "".join(_ESCAPED.get(letter, letter) for letter in text)


def _blocks(every: Sequence[Token]) -> Iterator[str]:
    """Yield the LaTeX of each token."""
    column, tall = 0, False
    for k, token in enumerate(every):
        if token.type == "inline":
            yield "".join(map(_inline, token.children or []))
        elif token.type == "fence":
            yield _fence(token)
        elif token.type == "paragraph_close":
            yield "\n" if token.hidden else "\n\n"
        elif token.type == "heading_open":
            yield _HEADINGS.get(token.tag, _HEADINGS["h3"])
        elif token.type == "table_open":
            tall = _rows(every[k:]) > _TALL
            opening = (
                "{\\footnotesize\n\\begin{longtable}[l]" if tall else "\\begin{widetable}\n\\begin{tabular}"
            )
            yield f"{opening}{{{_columns(every[k:])}}}\n"
        elif token.type == "thead_close":
            yield "\\hline\\endhead\n" if tall else "\\hline\n"
        elif token.type == "table_close":
            yield "\\end{longtable}}\n\n" if tall else "\\end{tabular}\n\\end{widetable}\n\n"
        elif token.type in ("th_open", "td_open"):
            yield " & " if column else ""
            column += 1
        elif token.type == "tr_close":
            yield " \\\\\n"
            column = 0
        else:
            yield _AROUND.get(token.type, escaped(token.content))


def _fence(token: Token) -> str:
    if token.info.strip() == "math":
        return f"\\[\n\\fitted{{{token.content.strip()}}}\n\\]\n\n"
    return f"\\texttt{{{escaped(token.content.strip())}}}\n\n"


def _rows(rest: Sequence[Token]) -> int:
    """Return the number of rows of the table that begins."""
    rows = 0
    for token in rest:
        if token.type == "table_close":
            break
        rows += token.type == "tr_open"
    return rows


def _columns(rest: Sequence[Token]) -> str:
    """Return the columns of the table that begins, as LaTeX.

    A column is l, or r if its cells are aligned to the right. In a table that is wider than a line, columns of long
    texts share the line and break their texts.
    """
    letters: list[str] = []
    longest: list[int] = []
    column = 0
    for token in rest:
        if token.type == "table_close":
            break
        if token.type == "th_open":
            letters.append("r" if "right" in str(token.attrs.get("style", "")) else "l")
            longest.append(0)
        if token.type in ("th_open", "td_open"):
            column += 1
        elif token.type == "tr_close":
            column = 0
        elif token.type == "inline":
            longest[column - 1] = max(longest[column - 1], len(token.content))
    if sum(longest) <= _LINE:
        return "".join(letters)
    shared = sum(n for n in longest if n > _WORDS)
    free = max(1 - sum(n for n in longest if n <= _WORDS) / _LINE, 0.2)
    columns = ""
    for letter, n in zip(letters, longest, strict=True):
        columns += (
            rf">{{\raggedright\arraybackslash}}p{{{free * n / shared:.2f}\linewidth}}"
            if n > _WORDS
            else letter
        )
    return columns


def _inline(token: Token) -> str:
    """Return the LaTeX of a part of a paragraph."""
    if token.type == "text":
        return escaped(token.content)
    if token.type == "code_inline":
        return rf"\texttt{{{escaped(token.content)}}}"
    if token.type == "html_inline":
        return _RAW.get(token.content, escaped(token.content))
    if token.type == "image":
        name = PurePosixPath(str(token.attrs["src"])).stem
        return rf"\drawing{{{name}}}"
    if token.type == "link_open":
        address = str(token.attrs["href"])
        return (
            rf"\href{{{escaped(address)}}}{{" if address.startswith("http") else "{"
        )  # a file next to report.md
    return _AROUND.get(token.type, escaped(token.content))
