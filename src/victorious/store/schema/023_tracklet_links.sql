-- What people say of the identity of tracklets, and the parameters of data association. docs/formats/index.md describes
-- every table and column.

CREATE TABLE tracklet_links (
  id           INTEGER PRIMARY KEY,
  correction   INTEGER NOT NULL,
  is_one       INTEGER NOT NULL,
  author       TEXT NOT NULL,
  made_utc_us  INTEGER NOT NULL
) STRICT;

-- As reviews, they are bound to places in videos, not to ids of tracklets, which change when a video is searched again.
CREATE TABLE tracklet_link_ends (
  link_id          INTEGER NOT NULL REFERENCES tracklet_links (id) ON DELETE CASCADE,
  is_second        INTEGER NOT NULL,
  video_content_id TEXT NOT NULL,
  model_name       TEXT NOT NULL,
  frame            INTEGER NOT NULL,
  box_x_px         REAL NOT NULL,
  box_y_px         REAL NOT NULL,
  box_width_px     REAL NOT NULL,
  box_height_px    REAL NOT NULL,
  PRIMARY KEY (link_id, is_second)
) STRICT, WITHOUT ROWID;

-- One row at most: those by which the present objects were made.
CREATE TABLE association_options (
  id    INTEGER PRIMARY KEY CHECK (id = 1),
  json  TEXT NOT NULL
) STRICT;
