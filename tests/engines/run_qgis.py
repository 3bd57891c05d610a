"""Opens every layer of a database in QGIS, as a person does who drags the file in, and draws them.

    QT_QPA_PLATFORM=offscreen run_qgis.py DATABASE PICTURE.png [WEST SOUTH EAST NORTH]

Prints a line a layer: how many rules its own style has. Stops where QGIS took another style, or draws nothing in a rule's colour that has
features. `docs/qgis.png` is the drawn region, made so:

    netcert ingest data/demo.osm.pbf --vehicle AU-SEMI19 && run_qgis.py demo.gpkg qgis.png 125.9535 -30.2415 125.9655 -30.2285
"""

import sys
from array import array
from itertools import islice

from qgis.core import (
    QgsApplication,
    QgsCoordinateReferenceSystem,
    QgsCoordinateTransform,
    QgsExpressionContext,
    QgsExpressionContextUtils,
    QgsMapRendererSequentialJob,
    QgsMapSettings,
    QgsProject,
    QgsProviderRegistry,
    QgsRectangle,
    QgsVectorLayer,
    QgsWkbTypes,
)
from qgis.PyQt.QtCore import QPointF, QSize
from qgis.PyQt.QtGui import QColor, QFont, QImage, QPainter

DATABASE, PICTURE = sys.argv[1:3]
# A panel a layer, beside each other, in pixels.
PANEL, HIGH, GAP, LINE = 560, 640, 16, 22
PAPER, INK = QColor("#f7f5f0"), QColor("#1b1f24")


def check(condition, *what):
    if not condition:
        sys.exit("refused: " + " ".join(map(str, what)))


def layers():
    details = QgsProviderRegistry.instance().querySublayers(DATABASE)
    spatial = [d for d in details if d.wkbType() != QgsWkbTypes.NoGeometry]
    found = {d.name(): QgsVectorLayer(d.uri(), d.name(), "ogr") for d in spatial}
    check(found and all(layer.isValid() for layer in found.values()), "not every layer can be opened")
    return found


def styled(name, layer):
    """The style that QGIS applied by itself."""
    renderer = layer.renderer()
    check(renderer.type() == "RuleRenderer", name, "is not drawn in its style but by", renderer.type())
    rules = renderer.rootRule().children()
    for rule in rules:
        check(rule.filter() is None or not rule.filter().hasParserError(), name, rule.label(), "cannot be read")
    print(f"{name}: {len(rules)} rules, {layer.featureCount()} features")
    lines = [rule for rule in rules if rule.symbol().symbolLayer(0).layerType() == "SimpleLine"]
    return [(rule.filterExpression(), rule.label(), rule.symbol().symbolLayer(0).color().rgb() & 0xFFFFFF) for rule in lines]


def draw(layer, box):
    web = QgsCoordinateReferenceSystem("EPSG:3857")
    across = QgsCoordinateTransform(QgsCoordinateReferenceSystem("EPSG:4326"), web, QgsProject.instance())
    settings = QgsMapSettings()
    settings.setLayers([layer])
    settings.setDestinationCrs(web)
    settings.setExtent(across.transformBoundingBox(box))
    settings.setOutputSize(QSize(PANEL, HIGH))
    settings.setOutputDpi(110)
    settings.setBackgroundColor(PAPER)
    # Widths follow the scale.
    context = QgsExpressionContext()
    context.appendScope(QgsExpressionContextUtils.mapSettingsScope(settings))
    settings.setExpressionContext(context)
    job = QgsMapRendererSequentialJob(settings)
    job.start()
    job.waitForFinished()
    check(not job.errors(), layer.name(), [error.message for error in job.errors()])
    return job.renderedImage()


def picture(shown, box):
    most = max(len(layer.renderer().rootRule().children()) for layer in shown)
    whole = QImage(len(shown) * (PANEL + GAP) - GAP, HIGH + (most + 2) * LINE, QImage.Format_RGB32)
    whole.fill(QColor("white"))
    painter = QPainter(whole)
    painter.setRenderHint(QPainter.Antialiasing)
    painter.setPen(INK)
    for at, layer in enumerate(shown):
        x, y = at * (PANEL + GAP), HIGH + LINE
        painter.drawImage(x, 0, draw(layer, box))
        painter.setFont(QFont("DejaVu Sans", 11, QFont.Bold))
        painter.drawText(QPointF(x + 4, y), layer.name())
        painter.setFont(QFont("DejaVu Sans", 10))
        for row, rule in enumerate(layer.renderer().rootRule().children(), 1):
            if rule.symbol().symbolLayer(0).layerType() in ("SimpleLine", "SimpleFill"):
                painter.drawImage(x + 4, y + row * LINE - 14, rule.symbol().asImage(QSize(44, 18)))
                painter.drawText(QPointF(x + 58, y + row * LINE), rule.label())
    painter.end()
    check(whole.save(PICTURE), "no picture")


def colours_of(image):
    image = image.convertToFormat(QImage.Format_RGB32)
    pixels = array("I", image.constBits().asstring(image.sizeInBytes()))
    return {pixel & 0xFFFFFF for pixel in pixels}


def shows(layer, expression, colour):
    """Whether a rule's features are drawn in its colour: of some of them nothing else lies on top."""
    some = list(islice(layer.getFeatures(expression), 12))
    boxes = [feature.geometry().boundingBox() for feature in some]
    return not some or any(colour in colours_of(draw(layer, box.buffered(1e-4))) for box in boxes)


def main():
    found = layers()
    rules = {name: styled(name, layer) for name, layer in found.items()}
    permits = sorted(name for name in found if name.startswith("permit_"))
    shown = [found["edge"], found["junction"], found["turn"], found[permits[-1]]]
    picture(shown, QgsRectangle(*map(float, sys.argv[3:7])) if len(sys.argv) > 3 else found["edge"].extent())
    for layer in shown:
        for expression, label, colour in rules[layer.name()]:
            check(shows(layer, expression, colour), layer.name(), label, "is not drawn in its colour")


application = QgsApplication([], True)
application.initQgis()
main()
# Everything of QGIS must be gone by now.
application.exitQgis()
