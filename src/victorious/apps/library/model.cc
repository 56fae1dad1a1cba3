#include "victorious/model.h"

#include <filesystem>
#include <optional>
#include <utility>

#include "victorious/apps/library/facade.h"
#include "victorious/object/mesh/load_mesh.h"
#include "victorious/object/model/cad_model.h"
#include "victorious/object/model/model_file.h"
#include "victorious/object/model/model_library.h"
#include "victorious/object/model/photo_model.h"

namespace libvictorious {
namespace {

static_assert(static_cast<int>(ModelKind::kCategory) == static_cast<int>(victorious::ModelKind::kCategory));

Model WrapModel(victorious::ObjectModel model) {
  return Model(std::make_shared<const Model::Impl>(Model::Impl{std::move(model)}));
}

// A model of the content that its file has: the id of one that was just made is the checksum of what is written.
Model WrapNewModel(const victorious::ObjectModel& model) {
  const auto bytes = std::make_shared<const std::vector<std::byte>>(Unwrap(victorious::EncodeModel(model)));
  return WrapModel(Unwrap(victorious::ParseModel(*bytes, bytes, model.name)));
}

victorious::Expected<victorious::ObjectModel> MakeCad(const std::string& name, const std::string& file,
                                                      const CadModelSettings& settings,
                                                      const victorious::CancelToken& cancel) {
  victorious::CadModelOptions options;
  VICTORIOUS_RETURN_IF_ERROR(ApplyParams(settings.params, options));
  if (settings.step_deg) options.sphere.step_deg = *settings.step_deg;
  if (settings.max_off_nadir_deg) options.sphere.max_off_nadir_deg = *settings.max_off_nadir_deg;
  victorious::LoadMeshOptions load{.up = {}, .front = {}, .length_m = settings.length_m, .cancel = &cancel};
  if (!settings.up.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(load.up, victorious::ParseAxis(settings.up));
  }
  if (!settings.front.empty()) {
    VICTORIOUS_ASSIGN_OR_RETURN(load.front, victorious::ParseAxis(settings.front));
  }
  VICTORIOUS_ASSIGN_OR_RETURN(const victorious::LoadedMesh loaded, victorious::LoadMesh(file, load));
  for (const std::string& warning : loaded.warnings) {
    if (settings.warn) settings.warn(file + ": " + warning);
  }
  std::optional<victorious::Progress> progress;
  const auto show = [&](int done, int all) {
    if (!progress) progress.emplace(name, all, "views");
    progress->Update(done);
  };
  auto model = victorious::MakeCadModel(name, loaded.mesh, file, options, show, &cancel);
  if (model) model->length_m = loaded.length_m;
  return model;
}

}  // namespace

Model Model::Load(const std::string& file) {
  return Guard([&] { return WrapModel(Unwrap(victorious::ReadModelFile(file))); });
}

const std::string& Model::name() const noexcept { return impl_->model.name; }
const std::string& Model::id() const noexcept { return impl_->model.id; }
ModelKind Model::kind() const noexcept { return static_cast<ModelKind>(impl_->model.kind); }
std::optional<double> Model::length_m() const noexcept { return impl_->model.length_m; }
std::size_t Model::views() const noexcept { return impl_->model.views.size(); }
std::size_t Model::features() const noexcept { return impl_->model.features.size(); }

Model::Model(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}
Model::Model(const Model& other) = default;
Model::Model(Model&& other) noexcept = default;
Model& Model::operator=(const Model& other) = default;
Model& Model::operator=(Model&& other) noexcept = default;
Model::~Model() = default;

Model MakeModelFromCad(const std::string& name, const std::string& file, const CadModelSettings& settings) {
  LongWork work(settings.progress);
  victorious::Expected<victorious::ObjectModel> made =
      Guard([&] { return MakeCad(name, file, settings, work.cancel()); });
  const victorious::ObjectModel model = work.Finish(std::move(made));
  return Guard([&] { return WrapNewModel(model); });
}

Model MakeModelFromPhotos(const std::string& name, const std::vector<PhotoOfObject>& photos,
                          const PhotoModelSettings& settings) {
  return Guard([&] {
    victorious::PhotoModelOptions options;
    Unwrap(ApplyParams(settings.params, options));
    std::vector<victorious::Photo> loaded;
    for (const PhotoOfObject& photo : photos) {
      std::optional<victorious::Box> box;
      if (photo.box) box = {photo.box->x, photo.box->y, photo.box->width, photo.box->height};
      loaded.push_back(Unwrap(victorious::LoadPhoto(photo.file, box)));
    }
    return WrapNewModel(Unwrap(victorious::MakePhotoModel(name, loaded, settings.length_m, options)));
  });
}

ModelLibrary::ModelLibrary(std::string folder) : folder_(std::move(folder)) {}
ModelLibrary::ModelLibrary(const ModelLibrary& other) = default;
ModelLibrary& ModelLibrary::operator=(const ModelLibrary& other) = default;
ModelLibrary::~ModelLibrary() = default;

std::vector<std::string> ModelLibrary::Names() const {
  return Guard([&] { return Unwrap(victorious::ModelLibrary(folder_).Names()); });
}

Model ModelLibrary::Load(const std::string& name) const {
  return Guard([&] { return WrapModel(Unwrap(victorious::ModelLibrary(folder_).Load(name))); });
}

std::vector<Model> ModelLibrary::LoadAll() const {
  return Guard([&] {
    std::vector<Model> models;
    for (victorious::ObjectModel& model : Unwrap(victorious::ModelLibrary(folder_).LoadAll())) {
      models.push_back(WrapModel(std::move(model)));
    }
    return models;
  });
}

void ModelLibrary::Add(const Model& model) const {
  Guard([&] {
    const victorious::ModelLibrary library(folder_);
    Unwrap(library.CheckNewName(model.name()));
    Unwrap(library.Add(model.impl().model));
  });
}

void ModelLibrary::Remove(const std::string& name) const {
  Guard([&] { Unwrap(victorious::ModelLibrary(folder_).Remove(name)); });
}

}  // namespace libvictorious
