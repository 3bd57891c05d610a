"""Colours of pictures and maps: those of Okabe and Ito, which people with any kind of colour vision tell apart."""

VERDICTS = {"safe": "#0072b2", "unsafe": "#d55e00", "forbidden": "#1b1f24", "unknown": "#8d949c"}
UNITS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#f0e442")
CONDITIONAL = "#cc79a7"
OBSTACLE = "#d55e00"
INK = "#1b1f24"
ROAD = "#e9eae6"
