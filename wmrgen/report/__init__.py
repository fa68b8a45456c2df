"""Write what people read about a robot: the report, its figures and pages for a browser.

The input is a `Derivation`; the output is Markdown (`sections`), SVG (`figures`) and HTML (`pages`), by file name.
This room computes nothing that other rooms need, and its pages load nothing from elsewhere.
"""
