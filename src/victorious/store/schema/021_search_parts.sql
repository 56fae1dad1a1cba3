-- The parts of a video as a search went through them. docs/formats/index.md describes every table and column.

CREATE TABLE search_parts (
  video_id   INTEGER NOT NULL,
  model_id   INTEGER NOT NULL,
  kind       TEXT NOT NULL,
  from_frame INTEGER NOT NULL,
  to_frame   INTEGER NOT NULL,
  from_s     REAL NOT NULL,
  to_s       REAL NOT NULL,
  PRIMARY KEY (video_id, model_id, from_frame, kind),
  FOREIGN KEY (video_id, model_id) REFERENCES searches (video_id, model_id) ON DELETE CASCADE
) STRICT, WITHOUT ROWID;

-- Of searches that were made before, what is known: the time of frames from the length of the video, or from the
-- frames that were kept. A search without either has no part.
INSERT INTO search_parts (video_id, model_id, kind, from_frame, to_frame, from_s, to_s)
SELECT video_id, model_id, 'searched', 0, next_frame, from_s, to_s FROM (
  SELECT s.video_id, s.model_id, s.next_frame, coalesce(iif(json_valid(o.json), json_extract(o.json, '$.searched.from_s'), NULL), 0.0) AS from_s,
    CASE WHEN s.finished = 1 AND v.duration_s IS NOT NULL
           THEN min(v.duration_s, coalesce(iif(json_valid(o.json), json_extract(o.json, '$.searched.to_s'), NULL), v.duration_s))
         WHEN v.frame_count > 1 AND v.duration_s IS NOT NULL
           THEN v.duration_s * min(1.0, (s.next_frame - 1.0) / (v.frame_count - 1))
         ELSE (SELECT max(k.time_s) FROM kept_frames k WHERE k.video_id = s.video_id AND k.frame < s.next_frame)
    END AS to_s
  FROM searches s JOIN videos v ON v.id = s.video_id JOIN options o ON o.id = s.options_id WHERE s.next_frame > 0)
WHERE to_s >= from_s;
