"""Detections as arrays, in the fields of supervision's Detections; that package is not needed."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


def _xyxy(boxes) -> np.ndarray:
    array = np.array(boxes, dtype=np.float32).reshape(-1, 4)
    array[:, 2:] += array[:, :2]
    return array


@dataclass
class Detections:
    """n boxes: each field has n rows.

    xyxy        float32 (n, 4): left, top, right, bottom, px
    confidence  float32 (n,): the score, 0 to 1
    class_id    int64 (n,): of the model
    tracker_id  int64 (n,): of the object; None for detections in single images
    data        further columns by name, arrays of n rows
    """

    xyxy: np.ndarray
    confidence: np.ndarray
    class_id: np.ndarray
    tracker_id: np.ndarray | None = None
    data: dict[str, np.ndarray] = field(default_factory=dict)
    mask: None = None

    def __len__(self) -> int:
        return len(self.xyxy)

    def __getitem__(self, rows) -> Detections:
        """Some of the rows: a slice, an array of indices or of booleans."""
        ids = None if self.tracker_id is None else self.tracker_id[rows]
        data = {name: column[rows] for name, column in self.data.items()}
        return Detections(self.xyxy[rows], self.confidence[rows], self.class_id[rows], ids, data)


def of_image(found) -> Detections:
    """The list that Recognizer.recognize() returns, as arrays: data has class_name, neg_log10_nfa and matches."""
    return Detections(
        xyxy=_xyxy([one.box for one in found]),
        confidence=np.array([one.score for one in found], dtype=np.float32),
        class_id=np.array([one.model for one in found], dtype=np.int64),
        data={
            "class_name": np.array([one.name for one in found], dtype=str),
            "neg_log10_nfa": np.array([one.neg_log10_nfa for one in found], dtype=float),
            "matches": np.array([one.matches for one in found], dtype=np.int64),
        },
    )


def of_sightings(sightings, objects, class_ids) -> Detections:
    """Sightings as arrays, with the place of the object of each.

    data: class_name, video, frame, time_s (s since the first frame), utc (datetime64[us], NaT: not known), tracked;
    latitude_deg, longitude_deg, altitude_m, ce90_m, le90_m and covariance_enu_m2 (n, 3, 3) of the object, NaN without
    a place."""
    places = {one.id: one.place for one in objects}

    def of_place(name: str) -> np.ndarray:
        found = [places.get(one.object) for one in sightings]
        return np.array([np.nan if place is None else getattr(place, name) for place in found], dtype=float)

    covariances = np.full((len(sightings), 3, 3), np.nan)
    for row, one in zip(covariances, sightings):
        place = places.get(one.object)
        if place is not None:
            row[:] = place.covariance_enu_m2
    utc = [np.datetime64("NaT", "us") if one.utc_us is None else np.datetime64(one.utc_us, "us") for one in sightings]
    data = {
        "class_name": np.array([one.model for one in sightings], dtype=str),
        "video": np.array([one.video for one in sightings], dtype=str),
        "frame": np.array([one.frame for one in sightings], dtype=np.int64),
        "time_s": np.array([one.time_s for one in sightings], dtype=float),
        "utc": np.array(utc, dtype="datetime64[us]"),
        "tracked": np.array([one.tracked for one in sightings], dtype=bool),
        "covariance_enu_m2": covariances,
    }
    for name in ("latitude_deg", "longitude_deg", "altitude_m", "ce90_m", "le90_m"):
        data[name] = of_place(name)
    return Detections(
        xyxy=_xyxy([one.box for one in sightings]),
        confidence=np.array([one.score for one in sightings], dtype=np.float32),
        class_id=np.array([class_ids[one.model] for one in sightings], dtype=np.int64),
        tracker_id=np.array([one.object for one in sightings], dtype=np.int64),
        data=data,
    )
