-- Decisions, and the team's review of each object, follow from reviews and from what was found. These functions write
-- them with the rights of the owner of the schema: who writes what was found needs no right to write decisions.

-- The team's review of objects: of their decisions the latest with a verdict, else the latest; NULL without any.
CREATE FUNCTION summarise_decisions(ids bigint[]) RETURNS void LANGUAGE sql AS $$
  UPDATE victorious.objects o
  SET (verdict, note, reviewer, reviewed_utc_us) =
        (SELECT d.verdict, d.note, d.reviewer, d.decided_utc_us FROM victorious.decisions d WHERE d.object_id = o.id
         ORDER BY d.verdict IS NULL, d.decided_utc_us DESC, d.reviewer LIMIT 1),
      is_contested = (SELECT CASE WHEN count(DISTINCT d.verdict) > 1 THEN 1 ELSE 0 END FROM victorious.decisions d
                      WHERE d.object_id = o.id)
  WHERE o.id = ANY (ids)
$$;

-- Each review with the object that it belongs to now. Two boxes in one frame show the same object if their intersection
-- over union is at least a half, which is 3 intersections >= the sum of both areas.
CREATE VIEW reviewed_tracklets AS
SELECT t.id AS tracklet_id, t.object_id, r.reviewer, r.verdict, r.note, r.updated_utc_us
FROM reviews r JOIN videos v ON v.content_id = r.video_content_id JOIN models m ON m.name = r.model_name
JOIN sightings s ON s.video_id = v.id AND s.frame = r.frame
JOIN tracklets t ON t.id = s.tracklet_id AND t.model_id = m.id AND t.object_id IS NOT NULL AND
  3 * greatest(0, least(r.box_x_px + r.box_width_px, s.box_x_px + s.box_width_px) - greatest(r.box_x_px, s.box_x_px)) *
      greatest(0, least(r.box_y_px + r.box_height_px, s.box_y_px + s.box_height_px) - greatest(r.box_y_px, s.box_y_px))
  >= r.box_width_px * r.box_height_px + s.box_width_px * s.box_height_px;

-- Makes the decisions of all objects anew; writes only what differs.
CREATE FUNCTION assign_all_reviews() RETURNS void LANGUAGE plpgsql
SECURITY DEFINER SET search_path = victorious, pg_temp AS $$
DECLARE
  changed bigint[];
BEGIN
  WITH wanted AS MATERIALIZED (
    SELECT DISTINCT ON (object_id, reviewer) object_id, reviewer, verdict, note, updated_utc_us AS decided_utc_us
    FROM reviewed_tracklets ORDER BY object_id, reviewer, updated_utc_us DESC),
  gone AS (
    DELETE FROM decisions d
    WHERE NOT EXISTS (SELECT FROM wanted w WHERE w.object_id = d.object_id AND w.reviewer = d.reviewer)
    RETURNING d.object_id),
  put AS (
    INSERT INTO decisions (object_id, reviewer, verdict, note, decided_utc_us)
    SELECT object_id, reviewer, verdict, note, decided_utc_us FROM wanted
    ON CONFLICT (object_id, reviewer) DO UPDATE
    SET verdict = excluded.verdict, note = excluded.note, decided_utc_us = excluded.decided_utc_us
    WHERE (decisions.verdict, decisions.note, decisions.decided_utc_us) IS DISTINCT FROM
      (excluded.verdict, excluded.note, excluded.decided_utc_us)
    RETURNING object_id)
  SELECT array_agg(object_id) INTO changed FROM (SELECT object_id FROM gone UNION SELECT object_id FROM put) c;
  PERFORM summarise_decisions(changed);
END $$;

-- Adds the decisions that follow from new tracklets.
CREATE FUNCTION assign_reviews_of(tracklets bigint[]) RETURNS void LANGUAGE plpgsql
SECURITY DEFINER SET search_path = victorious, pg_temp AS $$
DECLARE
  changed bigint[];
BEGIN
  IF NOT EXISTS (SELECT FROM reviews) THEN
    RETURN;
  END IF;
  WITH put AS (
    INSERT INTO decisions (object_id, reviewer, verdict, note, decided_utc_us)
    SELECT DISTINCT ON (object_id, reviewer) object_id, reviewer, verdict, note, updated_utc_us
    FROM reviewed_tracklets WHERE tracklet_id = ANY (tracklets) ORDER BY object_id, reviewer, updated_utc_us DESC
    ON CONFLICT (object_id, reviewer) DO UPDATE
    SET verdict = excluded.verdict, note = excluded.note, decided_utc_us = excluded.decided_utc_us
    WHERE excluded.decided_utc_us > decisions.decided_utc_us
    RETURNING object_id)
  SELECT array_agg(DISTINCT object_id) INTO changed FROM put;
  PERFORM summarise_decisions(changed);
END $$;
