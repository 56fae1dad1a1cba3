-- The parts of a video as a search went through them.

CREATE TABLE search_parts (
  video_id   bigint NOT NULL,
  model_id   bigint NOT NULL,
  kind       text NOT NULL,
  from_frame bigint NOT NULL,
  to_frame   bigint NOT NULL,
  from_s     double precision NOT NULL,
  to_s       double precision NOT NULL,
  PRIMARY KEY (video_id, model_id, from_frame, kind),
  FOREIGN KEY (video_id, model_id) REFERENCES searches (video_id, model_id) ON DELETE CASCADE
);

-- Of searches that were made before, what is known: as in version 21 of a file, without the gaps.
INSERT INTO search_parts (video_id, model_id, kind, from_frame, to_frame, from_s, to_s)
SELECT video_id, model_id, 'searched', 0, next_frame, from_s, to_s FROM (
  SELECT s.video_id, s.model_id, s.next_frame, coalesce((o.json::json #>> '{searched,from_s}')::float8, 0) AS from_s,
    CASE WHEN s.finished AND v.duration_s IS NOT NULL
           THEN least(v.duration_s, coalesce((o.json::json #>> '{searched,to_s}')::float8, v.duration_s))
         WHEN v.frame_count > 1 AND v.duration_s IS NOT NULL
           THEN v.duration_s * least(1, (s.next_frame - 1)::float8 / (v.frame_count - 1))
         ELSE (SELECT max(k.time_s) FROM kept_frames k WHERE k.video_id = s.video_id AND k.frame < s.next_frame)
    END AS to_s
  FROM searches s JOIN videos v ON v.id = s.video_id JOIN options o ON o.id = s.options_id WHERE s.next_frame > 0) known
WHERE to_s >= from_s;
