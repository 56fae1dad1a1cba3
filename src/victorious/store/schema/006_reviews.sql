-- Decisions of people about objects. docs/formats/index.md describes every table and column.

-- A review is bound to a place in a video, not to ids of objects or tracklets, which change when a video is searched
-- again: the object of this model that is in this box in this frame.
CREATE TABLE reviews (
  video_content_id TEXT NOT NULL,
  model_name       TEXT NOT NULL,
  frame            INTEGER NOT NULL,
  box_x_px         REAL NOT NULL,
  box_y_px         REAL NOT NULL,
  box_width_px     REAL NOT NULL,
  box_height_px    REAL NOT NULL,
  verdict          TEXT,
  note             TEXT NOT NULL,
  updated_utc_us   INTEGER NOT NULL,
  PRIMARY KEY (video_content_id, model_name, frame, box_x_px, box_y_px, box_width_px, box_height_px)
) STRICT, WITHOUT ROWID;
