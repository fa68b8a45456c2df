-- Prepares the pages of a robot for printing. Pandoc does not know GitHub's fences for formulas or subscripts in text. TeX
-- does not break lines in table columns without a width, and lets wide formulas run into the margin.

local begun = false
local widest, line = 30, 80  -- letters: the widest column that shares a table's width, and a line

function Meta(meta)
  meta.mainfont, meta.monofont = 'DejaVu Serif', 'DejaVu Sans Mono'
  meta.papersize, meta.fontsize, meta.geometry = 'a4', '10pt', 'margin=18mm'
  meta['header-includes'] = pandoc.MetaBlocks{pandoc.RawBlock('latex', [[
\usepackage{etoolbox,graphicx}
\newcommand\fitted[1]{\setbox0\hbox{$\displaystyle#1$}%
  \ifdim\wd0>\linewidth\resizebox{\linewidth}{!}{\box0}\else\box0\fi}
\AtBeginEnvironment{longtable}{\footnotesize\setlength\tabcolsep{3pt}}
\AtBeginDocument{\sloppy}
\ifdefined\pdfvariable\pdfvariable suppressoptionalinfo 519\fi % names of temporary folders]])}
  return meta
end

function Header(header)
  local next_page = begun and header.level == 1
  begun = true
  return next_page and {pandoc.RawBlock('latex', '\\clearpage'), header} or header
end

function CodeBlock(block)
  if block.classes[1] == 'math' then
    return pandoc.Para{pandoc.Math('DisplayMath', '\\fitted{' .. block.text .. '}')}
  end
end

function Inlines(inlines)
  local result, index = pandoc.List(), nil
  for _, part in ipairs(inlines) do
    if part.t == 'RawInline' and part.text == '<sub>' then
      index = pandoc.List()
    elseif part.t == 'RawInline' and part.text == '</sub>' then
      result:insert(pandoc.Subscript(index))
      index = nil
    else
      (index or result):insert(part)
    end
  end
  return result
end

function Para(para)  -- one picture below the other
  if para.content[1].t == 'Image' then
    return para.content:filter(function(part) return part.t == 'Image' end)
      :map(function(image) return pandoc.Para{image} end)
  end
end

function Link(link)
  return link.target:match '^https?:' and link or link.content
end

function Table(grid)
  local letters = {}
  local function measure(rows)
    for _, row in ipairs(rows) do
      for column, cell in ipairs(row.cells) do
        local length = utf8.len(pandoc.utils.stringify(cell.contents))
        letters[column] = math.max(letters[column] or 2, length + 2)
      end
    end
  end
  measure(grid.head.rows)
  for _, body in ipairs(grid.bodies) do measure(body.body) end
  local total, shared = 0, 0
  for _, length in ipairs(letters) do
    total, shared = total + length, shared + math.min(length, widest)
  end
  for column, length in ipairs(letters) do
    if total > line then grid.colspecs[column][2] = math.min(length, widest) / shared end
  end
  return grid
end
