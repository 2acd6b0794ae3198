"""What the rows of a study say: findings, tables, pages and pictures, from what `raypool study` leaves in a folder.

A module for each study, of its name, with summarise(run, rows) and PICTURES[name](run, rows); `run` is run.json and
`rows` are those of data.csv. What they share: data.py reads and writes the folder, spreads.py, efficiency.py,
crossover.py and verdict.py judge figures, summary.py is what a study says, page.py writes it down and drawing.py draws.
report.py makes a page to look into of a study, with points.py for its pictures; joined.py joins such pages, and comparison.py
holds two runs side by side.
"""
