"""Finds objects in video and places them on Earth.

    import victorious

    indexer = victorious.Indexer(victorious.ModelLibrary("models").load_all())
    indexer.index("flight.mp4", "index.db")
    for found in victorious.Index("index.db").objects():
        print(found.model, found.score, found.place and (found.place.latitude_deg, found.place.longitude_deg))

Images are numpy arrays of uint8: (height, width, 3) in the order BGR, or (height, width). Boxes are (x, y, width, height) in
pixels, from the left top corner. Times are seconds since the first frame of a video. What fails raises victorious.Error.
"""

from __future__ import annotations

from itertools import groupby
from typing import Iterator

from ._detections import Detections, of_image, of_sightings
from ._errors import (
    AlreadyExists, Cancelled, Conflict, DataLoss, Error, Internal, InvalidArgument, NoSpace, NotFound, PermissionDenied,
    Unavailable, Unsupported,
)  # fmt: skip
from ._native import (
    Detection, Filter, Frame, IndexedModel, IndexedVideo, Indexer, IndexReport, Model, ModelKind, ModelLibrary, Moment,
    Motion, NativeIndex, Object, Place, Progress, Recognizer, Sighting, Tracker, TrackStep, Video, __version__,
)  # fmt: skip


class Index:
    """An index (a SQLite file, or postgresql://USER@HOST/DATABASE), read only, while others may write it.

    Each list takes conditions that must all hold: model, category, video (names), from_s, to_s, object (an id),
    include_rejected, include_weak."""

    def __init__(self, name: str):
        self._native = NativeIndex(str(name))

    def videos(self) -> list[IndexedVideo]:
        return self._native.videos()

    def models(self) -> list[IndexedModel]:
        return self._native.models()

    def objects(self, **conditions) -> list[Object]:
        """Best first, as `victorious search` lists them."""
        return self._native.objects(Filter(**conditions))

    def sightings(self, **conditions) -> Iterator[Sighting]:
        """By video, frame and object."""
        return iter(self._native.sightings(Filter(**conditions)))

    def detections(self, **conditions) -> Detections:
        """The sightings as arrays; class_id counts the models of models()."""
        sightings = self._native.sightings(Filter(**conditions))
        ids = {model.name: number for number, model in enumerate(self.models())}
        return of_sightings(sightings, self._native.objects(Filter(include_rejected=True, include_weak=True)), ids)

    def frames(self, **conditions) -> Iterator[tuple[str, int, Detections]]:
        """The detections of each frame that has one: name of the video, number of the frame, its detections."""
        everything = self.detections(**conditions)
        keys = zip(everything.data["video"], everything.data["frame"], range(len(everything)))
        for (video, frame), rows in groupby(keys, key=lambda key: key[:2]):
            yield str(video), int(frame), everything[[row for _, _, row in rows]]

    def export(self, format: str, file: str, **conditions) -> None:
        """Writes a file as `victorious export --format` does."""
        self._native.export(format, str(file), Filter(**conditions))

    def to_pandas(self, **conditions):
        """The objects as a pandas.DataFrame, one row each, without a place NaN. Needs pandas."""
        import pandas

        return pandas.DataFrame([_row(one) for one in self.objects(**conditions)], columns=list(_COLUMNS))

    def to_geopandas(self, **conditions):
        """The objects that have a place, as a geopandas.GeoDataFrame of points in WGS 84. Needs geopandas."""
        import geopandas

        table = self.to_pandas(**conditions).dropna(subset=["latitude_deg"])
        points = geopandas.points_from_xy(table["longitude_deg"], table["latitude_deg"])
        return geopandas.GeoDataFrame(table, geometry=points, crs="EPSG:4326")


_COLUMNS = (
    "id", "rank", "model", "score", "frames", "latitude_deg", "longitude_deg", "altitude_m", "ce90_m", "le90_m",
    "heading_deg", "videos",
)  # fmt: skip


def _row(one: Object) -> dict:
    row = {name: getattr(one, name) for name in ("id", "rank", "model", "score", "frames", "heading_deg")}
    for name in ("latitude_deg", "longitude_deg", "altitude_m", "ce90_m", "le90_m"):
        row[name] = float("nan") if one.place is None else getattr(one.place, name)
    return row | {"videos": [moment.video for moment in one.moments]}


__all__ = [
    "AlreadyExists", "Cancelled", "Conflict", "DataLoss", "Detection", "Detections", "Error", "Frame", "Index",
    "IndexReport", "IndexedModel", "IndexedVideo", "Indexer", "Internal", "InvalidArgument", "Model", "ModelKind",
    "ModelLibrary", "Moment", "Motion", "NoSpace", "NotFound", "Object", "PermissionDenied", "Place", "Progress",
    "Recognizer", "Sighting", "TrackStep", "Tracker", "Unavailable", "Unsupported", "Video", "__version__", "of_image",
]  # fmt: skip
