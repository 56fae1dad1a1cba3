// Models of the objects to search for: made once from a CAD file or photos, kept in files.
//
//   Model model = MakeModelFromCad("jeep", "jeep.glb");
//   ModelLibrary("models").Add(model);  // the file that `victorious model add` writes
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <victorious/export.h>
#include <victorious/image.h>
#include <victorious/progress.h>

namespace libvictorious {

enum class ModelKind { kPhotos, kCad, kCategory };

/// An object as views with features. Never changes; copies share it. Thread-safe.
class LIBVICTORIOUS_EXPORT Model {
 public:
  /// Reads and checks a model file. Errors: kNotFound, kDataLoss, kUnsupported (of a newer version).
  [[nodiscard]] static Model Load(const std::string& file);

  [[nodiscard]] const std::string& name() const noexcept;
  /// A checksum of all that a search depends on: models of equal id find the same.
  [[nodiscard]] const std::string& id() const noexcept;
  [[nodiscard]] ModelKind kind() const noexcept;
  /// The longest side (of a glTF: the extent along its front axis), m; std::nullopt: not known.
  [[nodiscard]] std::optional<double> length_m() const noexcept;
  [[nodiscard]] std::size_t views() const noexcept;     ///< number of templates
  [[nodiscard]] std::size_t features() const noexcept;  ///< number of keypoints of all of them

  struct Impl;
  explicit Model(std::shared_ptr<const Impl> impl);  ///< of the library
  Model(const Model& other);
  Model(Model&& other) noexcept;
  Model& operator=(const Model& other);
  Model& operator=(Model&& other) noexcept;
  ~Model();

  [[nodiscard]] const Impl& impl() const noexcept { return *impl_; }  ///< of the library

 private:
  std::shared_ptr<const Impl> impl_;
};

struct CadModelSettings {
  /// Scales the object to this length (Model::length_m), m. std::nullopt: the unit of the file is the metre.
  std::optional<double> length_m;
  std::optional<double> step_deg;           ///< between views, degrees; std::nullopt: the default of the command
  std::optional<double> max_off_nadir_deg;  ///< largest off-nadir angle of the views; std::nullopt: likewise
  std::string up;                           ///< axis of the file that points up, as "+y"; empty: by format
  std::string front;                        ///< axis of the file that points to the front; empty: by format
  std::string params;                       ///< JSON object of parameters (`victorious params model`), or empty
  ProgressCallback progress;
  WarningCallback warn;
};

/// Makes a model of a CAD file (glTF, GLB, OBJ, AC3D, COLLADA, 3DS, PLY, STL), as `victorious model add` does. The file
/// is read by a process without rights.
/// Errors: kInvalidArgument, kNotFound, kDataLoss, kUnsupported, kCancelled; kInternal if no device can render. Cost:
/// seconds to a minute.
LIBVICTORIOUS_EXPORT Model MakeModelFromCad(const std::string& name, const std::string& file,
                                            const CadModelSettings& settings = {});

/// A photo of the object. The object is what is opaque in the box; without a box all that is opaque; without an alpha
/// channel the box or the whole photo.
struct PhotoOfObject {
  std::string file;
  std::optional<Box> box;
};

struct PhotoModelSettings {
  std::optional<double> length_m;  ///< the longest side of the object, m, if known
  std::string params;              ///< JSON object of parameters (`victorious params model`), or empty
};

/// Makes a model of photos, one view each. Errors: kInvalidArgument for no photos, or one with too few keypoints;
/// those of Image::Read.
LIBVICTORIOUS_EXPORT Model MakeModelFromPhotos(const std::string& name, const std::vector<PhotoOfObject>& photos,
                                               const PhotoModelSettings& settings = {});

/// A folder with one file a model, NAME.vmodel: what `--models` of the commands names.
class LIBVICTORIOUS_EXPORT ModelLibrary {
 public:
  explicit ModelLibrary(std::string folder);
  ModelLibrary(const ModelLibrary& other);
  ModelLibrary& operator=(const ModelLibrary& other);
  ~ModelLibrary();

  /// In alphabetical order. Error: kNotFound, no such folder.
  [[nodiscard]] std::vector<std::string> Names() const;
  /// Errors: kInvalidArgument, kNotFound, those of Model::Load.
  [[nodiscard]] Model Load(const std::string& name) const;
  /// All models, in alphabetical order.
  [[nodiscard]] std::vector<Model> LoadAll() const;
  /// Writes the model; creates the folder if it does not exist. Errors: kInvalidArgument for a name that is no file
  /// name of letters, digits, '.', '_' and '-'; kAlreadyExists; kPermissionDenied; kNoSpace.
  void Add(const Model& model) const;
  /// Errors: kInvalidArgument, kNotFound, kPermissionDenied.
  void Remove(const std::string& name) const;

 private:
  std::string folder_;
};

}  // namespace libvictorious
