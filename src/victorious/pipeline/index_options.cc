#include "victorious/pipeline/index_options.h"

namespace victorious {

void RunOptions::ListFields(FieldList& fields) {
  fields.Add("gap_s", gap_s,
             {.min = 0,
              .max = 3600,
              .unit = "s",
              .reason = "a sighting continues a run that was last seen no longer ago than this, than 2.5 "
                        "searched frames, or than a track may miss"});
  fields.Add("least_overlap", least_overlap,
             {.min = 0,
              .max = 1,
              .reason = "intersection over union that a sighting's box needs with the run's last one, taken on "
                        "as the picture and the object moved"});
  fields.Add(
      "gate_sigma", gate_sigma,
      {.min = 0,
       .max = 1e6,
       .reason = "a sighting whose line of sight or range is off the run's place by more sigmas than this begins "
                 "a new run, unless it was followed there"});
}

void KeepOptions::ListFields(FieldList& fields) {
  fields.Add("interval_s", interval_s,
             {.min = 0,
              .max = 1e6,
              .unit = "s",
              .reason = "the features of one frame in so many seconds are kept for search by picture; 0 keeps every "
                        "frame searched (docs/formats/index.md tells what they weigh)"});
}

void VideoOptions::ListFields(FieldList& fields) {
  fields.Add("folder_frame_rate", folder_frame_rate,
             {.min = 0.001,
              .max = 1000,
              .unit = "frames/s",
              .reason = "the times of a folder's pictures, which carry none of their own"});
}

void IndexOptions::ListFields(FieldList& fields) {
  ListSearchFields(fields);
  fields.AddGroup("objects", objects);
  fields.AddGroup("ground", ground);
}

void IndexOptions::ListSearchFields(FieldList& fields) {
  fields.AddGroup("video", video);
  fields.AddGroup("features", features);
  recognize.ListFields(fields);
  fields.AddGroup("categories", categories);
  fields.AddGroup("daylight", daylight);
  fields.AddGroup("telemetry", telemetry);
  fields.AddGroup("sight", sight);
  fields.AddGroup("follow", follow);
  fields.AddGroup("runs", runs);
  fields.AddGroup("keep", keep);
  fields.Add("live_wait_s", live_wait_s,
             {.min = 0,
              .max = 60,
              .unit = "s",
              .reason = "a live source's frame waits so long for telemetry of its moment or later, which may come once "
                        "a second; where none comes beside the frames, none waits"});
  fields.Add(
      "every", every,
      {.min = 1,
       .max = 1e6,
       .unit = "frames",
       .reason = "frames from one whole-frame search to the next; between them objects are followed, and sought in "
                 "their regions alone"});
}

}  // namespace victorious
