#include "victorious/pipeline/object_options.h"

#include <cmath>

namespace victorious {

void ObjectOptions::ListFields(FieldList& fields) {
  fields.Add("identity_gate_sigma", identity_gate_sigma,
             {.min = 0,
              .max = 100,
              .unit = "",
              .reason = "runs are one object if their places differ by at most so many sigmas; 0 joins none"});
  fields.Add("identity_slack_m", identity_slack_m,
             {.min = 0,
              .max = 1000,
              .unit = "m",
              .reason = "sigma added to each place when they are compared: the middle that one side shows is not quite "
                        "the middle that another shows"});
  fields.Add(
      "identity_farthest_m", identity_farthest_m,
      {.min = 0,
       .max = 1e5,
       .unit = "m",
       .reason = "places further apart are two objects, however uncertain: two of a kind may stand side by side"});
  fields.Add(
      "flight_share", flight_share,
      {.min = 0,
       .max = 1,
       .unit = "",
       .reason = "the share of a flight's common errors that does not cancel between two places of that flight"});
  fields.Add("least_agreeing", least_agreeing,
             {.min = 0,
              .max = 1,
              .unit = "",
              .reason = "the share of lines of sight that must meet at the place; of fewer, the object is rejected"});
  fields.Add("motion_window_s", motion_window_s,
             {.min = 0.1,
              .max = 1e6,
              .unit = "s",
              .reason = "what moves is placed by so much of its last time alone: it does not drive straight for ever"});
  fields.Add("scale_allowance", scale_allowance,
             {.min = 1,
              .max = 1e6,
              .unit = "",
              .reason = "an object that seems so many times too large or too small for its distance is rejected"});
  fields.Add(
      "floating_m", floating_m,
      {.min = 0,
       .max = 1e6,
       .unit = "m",
       .reason = "one whose height rests on its size alone, and is so far from the other objects', is rejected"});
  fields.Add("least_apart_m", least_apart_m,
             {.min = 0,
              .max = 1000,
              .unit = "m",
              .reason = "of two objects whose middles are nearer, the one seen less is rejected"});
  fields.Add(
      "same_pixels", same_pixels,
      {.min = 0,
       .max = 1,
       .reason = "of two objects of different CAD models the one seen less is rejected where their boxes overlap "
                 "by as much (intersection over union) in half of its frames"});
  fields.Add("false_share", false_share,
             {.min = 0,
              .max = 1,
              .unit = "",
              .reason = "finds of even odds that chance makes in a frame searched for a model; what is so faint that "
                        "chance makes more than a tenth of one in all that was searched is rejected; 0 rejects none"});
  fields.Add(
      "middle_above_ground_m", middle_above_ground_m,
      {.min = -100,
       .max = 1e4,
       .unit = "m",
       .reason = "how far the middle of objects is above the ground, where that is told: half a vehicle's height"});
  fields.Add("middle_sigma_m", middle_sigma_m,
             {.min = 0, .max = 1e4, .unit = "m", .reason = "sigma of that, beside the ground's own"});
  fields.AddGroup("locate", locate);
}

LocateOptions ObjectOptions::LocateOnGround() const {
  LocateOptions of_middle = locate;
  if (ground) {
    of_middle.ground = std::make_shared<const RaisedGround>(ground, middle_above_ground_m);
    of_middle.ground_sigma_m = std::hypot(locate.ground_sigma_m, middle_sigma_m);
  }
  return of_middle;
}

LocateOptions ObjectOptions::InVideo() {
  LocateOptions options;
  options.motion = "auto";
  options.line.position_m = 0.1;
  return options;
}

}  // namespace victorious
