-- The first schema of an index. docs/formats/index.md describes every table and column.

-- Option texts, each stored once.
CREATE TABLE options (
  id   INTEGER PRIMARY KEY,
  json TEXT NOT NULL UNIQUE
) STRICT;

CREATE TABLE videos (
  id               INTEGER PRIMARY KEY AUTOINCREMENT,
  content_id       TEXT NOT NULL UNIQUE,
  name             TEXT NOT NULL,
  width_px         INTEGER NOT NULL,
  height_px        INTEGER NOT NULL,
  frame_count      INTEGER,
  duration_s       REAL,
  features_options INTEGER REFERENCES options (id)
) STRICT;

CREATE TABLE models (
  id       INTEGER PRIMARY KEY AUTOINCREMENT,
  name     TEXT NOT NULL UNIQUE,
  model_id TEXT NOT NULL,
  kind     TEXT NOT NULL
) STRICT;

CREATE TABLE searches (
  video           INTEGER NOT NULL REFERENCES videos (id) ON DELETE CASCADE,
  model           INTEGER NOT NULL REFERENCES models (id) ON DELETE CASCADE,
  next_frame      INTEGER NOT NULL,
  finished        INTEGER NOT NULL,
  options         INTEGER NOT NULL REFERENCES options (id),
  program_version TEXT NOT NULL,
  PRIMARY KEY (video, model)
) STRICT, WITHOUT ROWID;
CREATE INDEX searches_by_model ON searches (model);

-- AUTOINCREMENT: the id of a forgotten object is never given to another.
CREATE TABLE objects (
  id           INTEGER PRIMARY KEY AUTOINCREMENT,
  video        INTEGER NOT NULL REFERENCES videos (id) ON DELETE CASCADE,
  model        INTEGER NOT NULL REFERENCES models (id) ON DELETE CASCADE,
  score        REAL NOT NULL,
  frames       INTEGER NOT NULL,
  first_time_s REAL NOT NULL,
  last_time_s  REAL NOT NULL
) STRICT;
CREATE INDEX objects_by_model ON objects (model, video);
CREATE INDEX objects_by_video ON objects (video);

-- The key is the order in which sightings are listed.
CREATE TABLE sightings (
  video         INTEGER NOT NULL REFERENCES videos (id) ON DELETE CASCADE,
  frame         INTEGER NOT NULL,
  object        INTEGER NOT NULL REFERENCES objects (id) ON DELETE CASCADE,
  time_s        REAL NOT NULL,
  box_x_px      REAL NOT NULL,
  box_y_px      REAL NOT NULL,
  box_width_px  REAL NOT NULL,
  box_height_px REAL NOT NULL,
  outline       BLOB NOT NULL,
  score         REAL NOT NULL,
  source        TEXT NOT NULL,
  matches       INTEGER NOT NULL,
  view_index    INTEGER NOT NULL,
  azimuth_rad   REAL,
  off_nadir_rad REAL,
  in_plane_rad  REAL NOT NULL,
  PRIMARY KEY (video, frame, object)
) STRICT, WITHOUT ROWID;
CREATE INDEX sightings_by_object ON sightings (object);

CREATE TABLE frame_features (
  video           INTEGER NOT NULL REFERENCES videos (id) ON DELETE CASCADE,
  frame           INTEGER NOT NULL,
  time_s          REAL NOT NULL,
  image_width_px  INTEGER NOT NULL,
  image_height_px INTEGER NOT NULL,
  keypoints       BLOB NOT NULL,
  descriptors     BLOB NOT NULL,
  PRIMARY KEY (video, frame)
) STRICT;
