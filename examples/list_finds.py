"""list_finds.py VIDEO MODELS INDEX: searches a video for every model of a folder, and prints what was found where."""

import sys

import victorious

video, models, index = sys.argv[1:]
victorious.Indexer(victorious.ModelLibrary(models).load_all()).index(video, index)
for found in victorious.Index(index).objects():
    place = found.place
    where = f"{place.latitude_deg:.6f} {place.longitude_deg:.6f} +-{place.ce90_m:.1f} m" if place else "no place"
    print(f"{found.model} {found.score:.3f} {where}")
