"""Opens a collection of a server of OGC API - Features in QGIS, as a person does who adds such a connection.

    QT_QPA_PLATFORM=offscreen run_qgis_features.py URL COLLECTION WEST SOUTH EAST NORTH FILTER

Prints JSON: the fields with their types, the ids of all features, of those in the box, and of those that a filter of QGIS finds.
"""

import json
import sys

from qgis.core import QgsApplication, QgsFeatureRequest, QgsRectangle, QgsVectorLayer

URL, COLLECTION = sys.argv[1:3]


def ids(layer, request=None):
    features = layer.getFeatures(request) if request else layer.getFeatures()
    return sorted(feature["id"] for feature in features)


def main():
    layer = QgsVectorLayer(f"url='{URL}' typename='{COLLECTION}'", COLLECTION, "OAPIF")
    if not layer.isValid():
        sys.exit(f"refused: QGIS cannot open {COLLECTION}")
    found = {"fields": {field.name(): field.typeName() for field in layer.fields()}, "all": ids(layer)}
    box = QgsRectangle(*map(float, sys.argv[3:7]))
    found["in_box"] = ids(layer, QgsFeatureRequest(box).setFlags(QgsFeatureRequest.ExactIntersect))
    layer.setSubsetString(sys.argv[7])
    found["filtered"] = ids(layer)
    print(json.dumps(found))


application = QgsApplication([], True)
application.initQgis()
main()
# Everything of QGIS must be gone by now.
application.exitQgis()
