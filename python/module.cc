// victorious._native: the classes of libvictorious for Python. What Python alone makes of them (detections as arrays,
// tables) is in victorious/. Pixels are numpy arrays that share their memory; long work runs without the interpreter's
// lock, and a signal (Ctrl-C) ends it.
#include <atomic>
#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <victorious/victorious.h>

namespace py = pybind11;
namespace lv = libvictorious;

namespace {

using Unlocked = py::call_guard<py::gil_scoped_release>;

// An array of bytes of any strides: it is not copied.
using Pixels = py::array;

lv::PixelFormat FormatOf(const std::string& name, py::ssize_t channels) {
  if (channels == 1) return lv::PixelFormat::kGrey;
  if (name == "bgr") return channels == 3 ? lv::PixelFormat::kBgr : lv::PixelFormat::kBgra;
  if (name == "rgb") return channels == 3 ? lv::PixelFormat::kRgb : lv::PixelFormat::kRgba;
  throw lv::Error(lv::ErrorCode::kInvalidArgument, "order \"" + name + "\": must be bgr or rgb");
}

lv::ImageView ViewOf(const Pixels& pixels, const std::string& order) {
  const py::ssize_t channels = pixels.ndim() == 3 ? pixels.shape(2) : 1;
  const bool is_image = (pixels.ndim() == 2 || pixels.ndim() == 3) && (channels == 1 || channels == 3 || channels == 4);
  if (!is_image || pixels.dtype().kind() != 'u' || pixels.itemsize() != 1) {
    throw lv::Error(
        lv::ErrorCode::kInvalidArgument,
        "image: must be an array of uint8 of shape (height, width), (height, width, 3) or (height, width, 4)");
  }
  if (pixels.strides(1) != channels || (pixels.ndim() == 3 && channels > 1 && pixels.strides(2) != 1)) {
    throw lv::Error(lv::ErrorCode::kInvalidArgument,
                    "image: the pixels of a row must follow each other in memory: give numpy.ascontiguousarray(image)");
  }
  constexpr py::ssize_t kTooLarge_px = 1 << 20;  // refused by the library, with its own message
  return {static_cast<const std::uint8_t*>(pixels.data()), static_cast<int>(std::min(pixels.shape(1), kTooLarge_px)),
          static_cast<int>(std::min(pixels.shape(0), kTooLarge_px)), pixels.strides(0), FormatOf(order, channels)};
}

// A read-only array on the pixels of `owner`, which it keeps alive.
template <typename Owner>
py::array ArrayOf(const lv::ImageView& view, const Owner& owner) {
  const py::ssize_t channels = lv::BytesPerPixel(view.format);
  std::vector<py::ssize_t> shape = {view.height, view.width};
  std::vector<py::ssize_t> strides = {view.stride_bytes, channels};
  if (channels > 1) {
    shape.push_back(channels);
    strides.push_back(1);
  }
  const py::capsule keeper(new Owner(owner), [](void* kept) { delete static_cast<Owner*>(kept); });
  py::array array(py::dtype::of<std::uint8_t>(), std::move(shape), std::move(strides), view.pixels, keeper);
  py::detail::array_proxy(array.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return array;
}

// Raises the exception of Python that victorious._errors has for the code.
void RaiseInPython(const lv::Error& error) {
  const py::object classes = py::module_::import("victorious._errors").attr("BY_CODE");
  const py::object type = classes[py::str(lv::Name(error.code()))];
  PyErr_SetObject(type.ptr(), py::str(error.what()).ptr());
}

// An object that one thread at a time may use, as the lock of the interpreter is released meanwhile.
template <typename T>
class OneAtATime {
 public:
  explicit OneAtATime(T object) : object_(std::move(object)) {}

  /// Error: kConflict while another thread, or a callback of this use, is at work with it.
  template <typename Use>
  auto Do(const Use& use) {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock) {
      throw lv::Error(lv::ErrorCode::kConflict,
                      "is in use: one thread at a time may call it; make one for each thread");
    }
    return use(object_);
  }

 private:
  T object_;
  std::mutex mutex_;
};

// A method of T as one of OneAtATime<T>.
template <typename T, typename Result, typename... Arguments>
auto Alone(Result (T::*method)(Arguments...)) {
  return [method](OneAtATime<T>& object, Arguments... arguments) {
    return object.Do([&](T& one) { return (one.*method)(arguments...); });
  };
}

template <typename T, typename Result, typename... Arguments>
auto Alone(Result (T::*method)(Arguments...) const) {
  return [method](OneAtATime<T>& object, Arguments... arguments) {
    return object.Do([&](const T& one) { return (one.*method)(arguments...); });
  };
}

using Video = OneAtATime<lv::Video>;
using Tracker = OneAtATime<lv::Tracker>;
using Indexer = OneAtATime<lv::Indexer>;
using Index = OneAtATime<lv::Index>;

// Runs long work on a thread of its own, while this one looks for signals: their handlers run on the main thread alone.
// What a callback in Python raises passes through.
// @param work  gets a callback to give to the library, which calls `progress` (a callable or None) and sees signals
template <typename Work>
auto Interruptible(const py::object& progress, const Work& work) {
  std::atomic<bool> is_stopped = false;
  const lv::ProgressCallback report = [&](const lv::Progress& one) {
    if (is_stopped) return false;
    const py::gil_scoped_acquire lock;
    if (progress.is_none()) return true;
    const py::object answer = progress(one);
    return answer.is_none() || answer.cast<bool>();  // a function without a return goes on
  };
  auto running = [&] {
    const py::gil_scoped_release unlocked;
    return std::async(std::launch::async, [&] { return work(report); });
  }();
  bool is_raised = false;
  while (true) {
    {
      const py::gil_scoped_release unlocked;
      if (running.wait_for(std::chrono::milliseconds(50)) == std::future_status::ready) break;
    }
    if (!is_raised && PyErr_CheckSignals() != 0) {
      is_raised = true;
      is_stopped = true;
    }
    if (is_raised) break;
  }
  if (is_raised) {
    const py::error_already_set raised;  // takes it, as the callbacks of the work use the interpreter
    {
      const py::gil_scoped_release unlocked;
      running.wait();
    }
    throw py::error_already_set(raised);
  }
  return running.get();
}

lv::WarningCallback WarningsTo(const py::object& warn) {
  return [&warn](const std::string& text) {
    const py::gil_scoped_acquire lock;
    try {
      if (!warn.is_none()) warn(text);
    } catch (py::error_already_set& raised) {
      raised.discard_as_unraisable("warn");  // a warning does not end the work
    }
  };
}

lv::Filter FilterOf(std::optional<std::string> model, std::optional<std::string> category,
                    std::optional<std::string> video, std::optional<double> from_s, std::optional<double> to_s,
                    std::optional<std::int64_t> object_id, bool include_rejected, bool include_weak) {
  return {std::move(model), std::move(category), std::move(video), from_s, to_s,
          object_id,        include_rejected,    include_weak};
}

py::array_t<double> ArrayOfPoints(const std::vector<lv::Point>& points) {
  py::array_t<double> array({static_cast<py::ssize_t>(points.size()), py::ssize_t{2}});
  auto rows = array.mutable_unchecked<2>();
  for (std::size_t i = 0; i < points.size(); ++i) {
    rows(static_cast<py::ssize_t>(i), 0) = points[i].x;
    rows(static_cast<py::ssize_t>(i), 1) = points[i].y;
  }
  return array;
}

lv::Box BoxOf(const std::array<double, 4>& xywh) { return {xywh[0], xywh[1], xywh[2], xywh[3]}; }
std::array<double, 4> TupleOf(const lv::Box& box) { return {box.x, box.y, box.width, box.height}; }

void DefineModels(py::module_& module) {
  py::enum_<lv::ModelKind>(module, "ModelKind")
      .value("PHOTOS", lv::ModelKind::kPhotos)
      .value("CAD", lv::ModelKind::kCad)
      .value("CATEGORY", lv::ModelKind::kCategory);
  py::class_<lv::Model>(module, "Model", "An object as views with features; never changes.")
      .def_static("load", &lv::Model::Load, py::arg("file"), Unlocked(), "Reads a model file.")
      .def_static(
          "from_cad",
          [](const std::string& name, const std::string& file, std::optional<double> length_m,
             std::optional<double> step_deg, std::optional<double> max_off_nadir_deg, const std::string& up,
             const std::string& front, const std::string& params, const py::object& progress, const py::object& warn) {
            return Interruptible(progress, [&](const lv::ProgressCallback& report) {
              return lv::MakeModelFromCad(
                  name, file, {length_m, step_deg, max_off_nadir_deg, up, front, params, report, WarningsTo(warn)});
            });
          },
          py::arg("name"), py::arg("file"), py::kw_only(), py::arg("length_m") = py::none(),
          py::arg("step_deg") = py::none(), py::arg("max_off_nadir_deg") = py::none(), py::arg("up") = "",
          py::arg("front") = "", py::arg("params") = "", py::arg("progress") = py::none(), py::arg("warn") = py::none(),
          "Makes a model of a CAD file, as `victorious model add` does.")
      .def_static(
          "from_photos",
          [](const std::string& name, const std::vector<std::string>& files,
             const std::optional<std::vector<std::array<double, 4>>>& boxes, std::optional<double> length_m,
             const std::string& params) {
            if (boxes && boxes->size() != files.size()) {
              throw lv::Error(lv::ErrorCode::kInvalidArgument, "boxes: give one for each photo, or none");
            }
            std::vector<lv::PhotoOfObject> photos;
            for (std::size_t i = 0; i < files.size(); ++i) {
              photos.push_back({files[i], boxes ? std::optional(BoxOf((*boxes)[i])) : std::nullopt});
            }
            const py::gil_scoped_release unlocked;
            return lv::MakeModelFromPhotos(name, photos, {length_m, params});
          },
          py::arg("name"), py::arg("files"), py::kw_only(), py::arg("boxes") = py::none(),
          py::arg("length_m") = py::none(), py::arg("params") = "",
          "Makes a model of photos, one view each; boxes are (x, y, width, height) in pixels.")
      .def_property_readonly("name", &lv::Model::name)
      .def_property_readonly("id", &lv::Model::id, "Models of equal id find the same.")
      .def_property_readonly("kind", &lv::Model::kind)
      .def_property_readonly("length_m", &lv::Model::length_m, "The longest side, m, or None.")
      .def_property_readonly("views", &lv::Model::views, "Number of templates.")
      .def_property_readonly("features", &lv::Model::features, "Number of keypoints of all of them.")
      .def("__repr__", [](const lv::Model& model) { return "<victorious.Model " + model.name() + ">"; });
  py::class_<lv::ModelLibrary>(module, "ModelLibrary", "A folder with one file a model.")
      .def(py::init<std::string>(), py::arg("folder"))
      .def("names", &lv::ModelLibrary::Names, Unlocked())
      .def("load", &lv::ModelLibrary::Load, py::arg("name"), Unlocked())
      .def("load_all", &lv::ModelLibrary::LoadAll, Unlocked())
      .def("add", &lv::ModelLibrary::Add, py::arg("model"), Unlocked())
      .def("remove", &lv::ModelLibrary::Remove, py::arg("name"), Unlocked());
}

void DefineVideos(py::module_& module) {
  py::class_<lv::Progress>(module, "Progress")
      .def_readonly("label", &lv::Progress::label)
      .def_readonly("done", &lv::Progress::done)
      .def_readonly("total", &lv::Progress::total)
      .def_readonly("unit", &lv::Progress::unit)
      .def_readonly("elapsed_s", &lv::Progress::elapsed_s);
  py::class_<lv::Frame>(module, "Frame", "A decoded image with its time.")
      .def_property_readonly("index", &lv::Frame::index, "From 0, in order of presentation.")
      .def_property_readonly("time_s", &lv::Frame::time_s, "Seconds since the first frame of the video.")
      .def_property_readonly(
          "image", [](const lv::Frame& frame) { return ArrayOf(frame.image(), frame); },
          "uint8, (height, width, 3) in the order BGR, or (height, width); read-only, not copied.");
  const auto info_of = [](Video& video) { return video.Do([](lv::Video& one) { return one.info(); }); };
  py::class_<Video>(module, "Video", "Iterates over the frames of a video by presentation time.")
      .def(py::init([](const std::string& source, bool grey, int threads, double folder_frame_rate) {
             const py::gil_scoped_release unlocked;
             return std::make_unique<Video>(lv::Video(
                 source, {grey ? lv::PixelFormat::kGrey : lv::PixelFormat::kBgr, threads, folder_frame_rate}));
           }),
           py::arg("source"), py::kw_only(), py::arg("grey") = false, py::arg("threads") = 0,
           py::arg("folder_frame_rate") = 10.0)
      .def(
          "__iter__", [](Video& video) -> Video& { return video; }, py::return_value_policy::reference_internal)
      .def("__next__",
           [](Video& video) {
             std::optional<lv::Frame> frame;
             {
               const py::gil_scoped_release unlocked;
               frame = video.Do([](lv::Video& one) { return one.Next(); });
             }
             if (!frame) throw py::stop_iteration();
             return *frame;
           })
      .def("seek", Alone(&lv::Video::SeekTo), py::arg("time_s"), Unlocked(),
           "Goes to a key frame at or shortly before a time; False: the source cannot.")
      .def_property_readonly("width", [=](Video& video) { return info_of(video).width; })
      .def_property_readonly("height", [=](Video& video) { return info_of(video).height; })
      .def_property_readonly("frame_rate", [=](Video& video) { return info_of(video).frame_rate; })
      .def_property_readonly("duration_s", [=](Video& video) { return info_of(video).duration_s; })
      .def_property_readonly("warnings", Alone(&lv::Video::warnings));
}

void DefineSearch(py::module_& module) {
  py::class_<lv::Detection>(module, "Detection", "An object in one image.")
      .def_readonly("model", &lv::Detection::model, "Index into the models of the recogniser.")
      .def_readonly("name", &lv::Detection::name)
      .def_readonly("score", &lv::Detection::score)
      .def_readonly("neg_log10_nfa", &lv::Detection::neg_log10_nfa)
      .def_readonly("matches", &lv::Detection::matches)
      .def_readonly("view", &lv::Detection::view)
      .def_property_readonly(
          "box", [](const lv::Detection& one) { return TupleOf(one.box); }, "x, y, width, height, px.")
      .def_property_readonly("outline", [](const lv::Detection& one) { return ArrayOfPoints(one.outline); });
  py::class_<lv::Recognizer>(module, "Recognizer", "Finds the instances of models in single images.")
      .def(py::init([](const std::vector<lv::Model>& models, const std::string& params) {
             const py::gil_scoped_release unlocked;
             return lv::Recognizer(models, {params});
           }),
           py::arg("models"), py::kw_only(), py::arg("params") = "")
      .def(
          "recognize",
          [](const lv::Recognizer& recognizer, const Pixels& image, const std::string& order) {
            const lv::ImageView view = ViewOf(image, order);
            const py::gil_scoped_release unlocked;
            return recognizer.Recognize(view);
          },
          py::arg("image"), py::kw_only(), py::arg("order") = "bgr", "The detections of all models, best first.");
  py::class_<lv::TrackStep>(module, "TrackStep")
      .def_readonly("target", &lv::TrackStep::target)
      .def_property_readonly("seen", &lv::TrackStep::seen)
      .def_property_readonly(
          "box", [](const lv::TrackStep& one) { return TupleOf(one.box); }, "x, y, width, height, px.")
      .def_readonly("confidence", &lv::TrackStep::confidence)
      .def_readonly("tentative", &lv::TrackStep::tentative);
  py::class_<Tracker>(module, "Tracker", "Follows boxes from frame to frame, without a model.")
      .def(py::init([](const std::string& params) { return std::make_unique<Tracker>(lv::Tracker({params})); }),
           py::kw_only(), py::arg("params") = "")
      .def(
          "step",
          [](Tracker& tracker, const Pixels& image, const std::string& order) {
            const lv::ImageView view = ViewOf(image, order);
            const py::gil_scoped_release unlocked;
            return tracker.Do([&](lv::Tracker& one) { return one.Step(view); });
          },
          py::arg("image"), py::kw_only(), py::arg("order") = "bgr",
          "One result for each box, in the order of start().")
      .def(
          "start",
          [](Tracker& tracker, const std::array<double, 4>& box) {
            return tracker.Do([&](lv::Tracker& one) { return one.Start(BoxOf(box)); });
          },
          py::arg("box"), "Starts a box (x, y, width, height), px, in the frame of the last step().")
      .def("change_video", Alone(&lv::Tracker::ChangeVideo));
  py::class_<lv::IndexReport>(module, "IndexReport")
      .def_readonly("has_telemetry", &lv::IndexReport::has_telemetry)
      .def_readonly("frames_searched", &lv::IndexReport::frames_searched)
      .def_readonly("sightings", &lv::IndexReport::sightings);
  py::class_<Indexer>(module, "Indexer", "Searches videos for models, and stores what it finds.")
      .def(py::init([](const std::vector<lv::Model>& models, const std::string& categories, const std::string& quality,
                       const std::string& params, std::optional<double> hfov_deg, const py::object& warn) {
             const py::gil_scoped_release unlocked;
             return std::make_unique<Indexer>(
                 lv::Indexer(models, {categories, quality, params, hfov_deg, WarningsTo(warn)}));
           }),
           py::arg("models"), py::kw_only(), py::arg("categories") = "", py::arg("quality") = "",
           py::arg("params") = "", py::arg("hfov_deg") = py::none(), py::arg("warn") = py::none())
      .def(
          "index",
          [](Indexer& indexer, const std::string& video, const std::string& db, const std::string& telemetry,
             std::optional<double> from_s, std::optional<double> to_s, bool redo, int threads,
             const py::object& progress, const py::object& warn) {
            return Interruptible(progress, [&](const lv::ProgressCallback& report) {
              return indexer.Do([&](lv::Indexer& one) {
                return one.Index(video, db, {telemetry, from_s, to_s, redo, threads, report, WarningsTo(warn)});
              });
            });
          },
          py::arg("video"), py::arg("db"), py::kw_only(), py::arg("telemetry") = "", py::arg("from_s") = py::none(),
          py::arg("to_s") = py::none(), py::arg("redo") = false, py::arg("threads") = 0,
          py::arg("progress") = py::none(), py::arg("warn") = py::none(),
          "Indexes one video, as `victorious index` does. progress is called with a Progress, and returns False to "
          "end.");
}

void DefinePlaces(py::module_& module) {
  py::class_<lv::Motion>(module, "Motion")
      .def_readonly("speed_m_s", &lv::Motion::speed_m_s)
      .def_readonly("sigma_speed_m_s", &lv::Motion::sigma_speed_m_s)
      .def_readonly("course_deg", &lv::Motion::course_deg)
      .def_readonly("sigma_course_deg", &lv::Motion::sigma_course_deg);
  py::class_<lv::Place>(module, "Place", "A place on Earth (WGS 84, height above the ellipsoid) with its error.")
      .def_readonly("latitude_deg", &lv::Place::latitude_deg)
      .def_readonly("longitude_deg", &lv::Place::longitude_deg)
      .def_readonly("altitude_m", &lv::Place::altitude_m)
      .def_readonly("time_s", &lv::Place::time_s)
      .def_property_readonly(
          "covariance_enu_m2",
          [](const lv::Place& place) { return py::array_t<double>({3, 3}, place.covariance_enu_m2.data()); },
          "float64, (3, 3): east, north, up, m^2.")
      .def_readonly("ce90_m", &lv::Place::ce90_m)
      .def_readonly("le90_m", &lv::Place::le90_m)
      .def_readonly("motion", &lv::Place::motion);
  py::class_<lv::Moment>(module, "Moment", "An object in one video.")
      .def_readonly("video", &lv::Moment::video)
      .def_readonly("first_time_s", &lv::Moment::first_time_s)
      .def_readonly("last_time_s", &lv::Moment::last_time_s)
      .def_readonly("frames", &lv::Moment::frames)
      .def_readonly("video_start_utc_us", &lv::Moment::video_start_utc_us);
  py::class_<lv::Object>(module, "Object", "What was seen in one or more videos and is one object.")
      .def_readonly("id", &lv::Object::id)
      .def_readonly("rank", &lv::Object::rank)
      .def_readonly("model", &lv::Object::model)
      .def_readonly("is_category", &lv::Object::is_category)
      .def_readonly("score", &lv::Object::score)
      .def_readonly("frames", &lv::Object::frames)
      .def_readonly("place", &lv::Object::place)
      .def_readonly("heading_deg", &lv::Object::heading_deg)
      .def_readonly("moments", &lv::Object::moments)
      .def_readonly("rejected", &lv::Object::rejected)
      .def_readonly("place_rejected", &lv::Object::place_rejected)
      .def_readonly("against", &lv::Object::against)
      .def("__repr__", [](const lv::Object& one) {
        return "<victorious.Object " + std::to_string(one.id) + " " + one.model + ">";
      });
  py::class_<lv::Sighting>(module, "Sighting", "An object in one frame.")
      .def_readonly("object", &lv::Sighting::object)
      .def_readonly("model", &lv::Sighting::model)
      .def_readonly("is_category", &lv::Sighting::is_category)
      .def_readonly("video", &lv::Sighting::video)
      .def_readonly("frame", &lv::Sighting::frame)
      .def_readonly("time_s", &lv::Sighting::time_s)
      .def_property_readonly(
          "box", [](const lv::Sighting& one) { return TupleOf(one.box); }, "x, y, width, height, px.")
      .def_property_readonly("outline", [](const lv::Sighting& one) { return ArrayOfPoints(one.outline); })
      .def_readonly("score", &lv::Sighting::score)
      .def_property_readonly("tracked",
                             [](const lv::Sighting& one) { return one.source == lv::SightingSource::kTracked; })
      .def_readonly("matches", &lv::Sighting::matches)
      .def_readonly("distance_m", &lv::Sighting::distance_m)
      .def_readonly("sigma_distance_m", &lv::Sighting::sigma_distance_m)
      .def_readonly("utc_us", &lv::Sighting::utc_us);
}

void DefineIndex(py::module_& module) {
  py::class_<lv::IndexedVideo>(module, "IndexedVideo")
      .def_readonly("name", &lv::IndexedVideo::name)
      .def_readonly("width", &lv::IndexedVideo::width)
      .def_readonly("height", &lv::IndexedVideo::height)
      .def_readonly("frame_count", &lv::IndexedVideo::frame_count)
      .def_readonly("duration_s", &lv::IndexedVideo::duration_s)
      .def_readonly("start_utc_us", &lv::IndexedVideo::start_utc_us);
  py::class_<lv::IndexedModel>(module, "IndexedModel")
      .def_readonly("name", &lv::IndexedModel::name)
      .def_readonly("id", &lv::IndexedModel::id)
      .def_readonly("kind", &lv::IndexedModel::kind);
  py::class_<lv::Filter>(module, "Filter", "Conditions that must all hold.")
      .def(py::init(&FilterOf), py::kw_only(), py::arg("model") = py::none(), py::arg("category") = py::none(),
           py::arg("video") = py::none(), py::arg("from_s") = py::none(), py::arg("to_s") = py::none(),
           py::arg("object") = py::none(), py::arg("include_rejected") = false, py::arg("include_weak") = false);
  py::class_<Index>(module, "NativeIndex", "An index, read only.")
      .def(py::init([](const std::string& name) { return std::make_unique<Index>(lv::Index(name)); }), py::arg("name"),
           Unlocked())
      .def("videos", Alone(&lv::Index::Videos), Unlocked())
      .def("models", Alone(&lv::Index::Models), Unlocked())
      .def("objects", Alone(&lv::Index::Objects), py::arg("filter"), Unlocked())
      .def("sightings", Alone(&lv::Index::Sightings), py::arg("filter"), Unlocked())
      .def("export", Alone(&lv::Index::Export), py::arg("format"), py::arg("file"), py::arg("filter"), Unlocked());
}

}  // namespace

PYBIND11_MODULE(_native, module) {
  module.doc() = "The classes of libvictorious.";
  module.attr("__version__") = lv::Version();
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const lv::Error& error) {
      RaiseInPython(error);
    }
  });
  DefineModels(module);
  DefineVideos(module);
  DefineSearch(module);
  DefinePlaces(module);
  DefineIndex(module);
}
