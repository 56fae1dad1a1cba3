#include "victorious/object/mesh/assimp_import.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <filesystem>
#include <iterator>
#include <map>
#include <new>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <assimp/GltfMaterial.h>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/material.h>
#include <assimp/mesh.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "victorious/base/enum_text.h"
#include "victorious/base/text.h"
#include "victorious/input/image/srgb.h"
#include "victorious/object/mesh/assimp_io.h"
#include "victorious/object/mesh/readable_file.h"
#include "victorious/object/mesh/texture_image.h"

namespace victorious {
namespace {

// A name or message from outside: truncated, control characters replaced by spaces.
std::string ShortText(std::string_view text) {
  constexpr std::size_t kMaxTextLength = 200;
  std::string line(text.substr(0, kMaxTextLength));
  std::ranges::replace_if(line, [](unsigned char c) { return c < 0x20 || c == 0x7F; }, ' ');
  return line;
}

float ClampToUnit(float value) { return std::isfinite(value) ? std::clamp(value, 0.0F, 1.0F) : 1.0F; }

class SceneConverter {
 public:
  SceneConverter(const aiScene& scene, const CadFolder& folder, CadFormat format)
      : scene_(scene), folder_(folder), format_(format) {}

  Expected<LoadedMesh> Convert() {
    FindTransforms();
    for (unsigned i = 0; i < scene_.mNumMaterials; ++i) AddMaterial(*scene_.mMaterials[i]);
    for (int material = 0; std::cmp_less(material, scene_.mNumMaterials); ++material) {
      VICTORIOUS_RETURN_IF_ERROR(AddPart(material));
    }
    ShowIfInvisible();
    for (Material& material : mesh().materials) SetOpaqueIfNoAlpha(material);
    AddWarnings();
    return std::move(loaded_);
  }

 private:
  struct PlacedMesh {
    const aiMesh* mesh;
    aiMatrix4x4 file_from_mesh;
  };
  // The texture coordinates of a material: UV channel and transform.
  struct UvSource {
    unsigned channel = 0;
    Eigen::Affine2f transform = Eigen::Affine2f::Identity();
  };

  Mesh& mesh() { return loaded_.mesh; }
  [[nodiscard]] bool IsGltf() const { return format_ == CadFormat::kGltf; }

  // Traverses the node graph; collects every mesh instance with its accumulated transform.
  void FindTransforms() {
    std::vector<std::pair<const aiNode*, aiMatrix4x4>> open;
    if (scene_.mRootNode != nullptr) open.emplace_back(scene_.mRootNode, scene_.mRootNode->mTransformation);
    while (!open.empty()) {
      const auto [node, transform] = open.back();
      open.pop_back();
      for (unsigned i = 0; i < node->mNumMeshes; ++i) placed_.push_back({scene_.mMeshes[node->mMeshes[i]], transform});
      for (unsigned i = node->mNumChildren; i > 0; --i) {
        const aiNode* child = node->mChildren[i - 1];
        open.emplace_back(child, transform * child->mTransformation);
      }
    }
  }

  [[nodiscard]] bool HasVertexColours(unsigned material) const {
    return std::ranges::any_of(placed_, [&](const PlacedMesh& placed) {
      return placed.mesh->mMaterialIndex == material && placed.mesh->HasVertexColors(0);
    });
  }

  void AddMaterial(const aiMaterial& source) {
    Material material;
    material.name = ShortText(source.GetName().C_Str());
    uv_sources_.push_back(AddTexture(source, material));
    material.base_colour = BaseColour(source, material.texture >= 0);
    if (IsGltf()) {
      ReadGltfAlphaAndSides(source, material);
    } else {
      material.double_sided = true;
      if (material.base_colour.w() < 1.0F) material.alpha_mode = AlphaMode::kBlend;
      if (material.alpha_mode == AlphaMode::kOpaque && TextureHasAlpha(material))
        material.alpha_mode = AlphaMode::kMask;
    }
    mesh().materials.push_back(std::move(material));
  }

  static void ReadGltfAlphaAndSides(const aiMaterial& source, Material& material) {
    aiString mode;
    if (source.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == aiReturn_SUCCESS) {
      if (mode == aiString("MASK")) material.alpha_mode = AlphaMode::kMask;
      if (mode == aiString("BLEND")) material.alpha_mode = AlphaMode::kBlend;
    }
    float cutoff = 0.5F;
    if (source.Get(AI_MATKEY_GLTF_ALPHACUTOFF, cutoff) == aiReturn_SUCCESS) material.alpha_cutoff = ClampToUnit(cutoff);
    int two_sided = 0;
    material.double_sided = source.Get(AI_MATKEY_TWOSIDED, two_sided) == aiReturn_SUCCESS && two_sided != 0;
  }

  Eigen::Vector4f BaseColour(const aiMaterial& source, bool textured) const {
    aiColor4D colour(1, 1, 1, 1);
    if (IsGltf()) {
      if (source.Get(AI_MATKEY_BASE_COLOR, colour) != aiReturn_SUCCESS) source.Get(AI_MATKEY_COLOR_DIFFUSE, colour);
      return {ClampToUnit(colour.r), ClampToUnit(colour.g), ClampToUnit(colour.b), ClampToUnit(colour.a)};
    }
    source.Get(AI_MATKEY_COLOR_DIFFUSE, colour);
    float opacity = 1;
    source.Get(AI_MATKEY_OPACITY, opacity);
    // If a texture or the vertices define the colour, editors write black and the importer its default grey.
    const bool unset = textured && colour.r == 0 && colour.g == 0 && colour.b == 0;
    if (unset || HasVertexColours(static_cast<unsigned>(mesh_materials()))) colour = {1, 1, 1, 1};
    const auto linear = [](float value) { return LinearFromSrgb(ClampToUnit(value)); };
    return {linear(colour.r), linear(colour.g), linear(colour.b), ClampToUnit(opacity)};
  }

  [[nodiscard]] std::size_t mesh_materials() const { return loaded_.mesh.materials.size(); }

  // Adds the base-colour texture, if the material has one.
  UvSource AddTexture(const aiMaterial& source, Material& material) {
    aiTextureType type = aiTextureType_BASE_COLOR;
    if (source.GetTextureCount(type) == 0) type = aiTextureType_DIFFUSE;
    aiString name;
    UvSource uv;
    std::array<aiTextureMapMode, 3> wrap = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
    if (source.GetTexture(type, 0, &name, nullptr, &uv.channel, nullptr, nullptr, wrap.data()) != aiReturn_SUCCESS) {
      return {};
    }
    material.texture = TextureIndex(name.C_Str());
    material.wrap_u = ConvertWrap(wrap[0]);
    material.wrap_v = ConvertWrap(wrap[1]);
    aiUVTransform transform;
    if (IsGltf() && source.Get(AI_MATKEY_UVTRANSFORM(type, 0), transform) == aiReturn_SUCCESS) {
      uv.transform = GltfTransform(transform);
    }
    return uv;
  }

  // KHR_texture_transform: scale, rotation, translation about the image's left upper corner. The importer rewrites the
  // offset for a rotation about the centre and an origin at the bottom; this undoes it.
  static Eigen::Affine2f GltfTransform(const aiUVTransform& imported) {
    const float c = std::cos(imported.mRotation);
    const float s = -std::sin(imported.mRotation);  // the importer negates the angle
    const aiVector2D& scale = imported.mScaling;
    const aiVector2D& moved = imported.mTranslation;
    Eigen::Affine2f transform;
    transform.translation() << moved.x - 0.5F * scale.x * (1 - c + s),
        1 - scale.y + 0.5F * scale.y * (s + c - 1) - moved.y;
    transform.linear() << c * scale.x, s * scale.y, -s * scale.x, c * scale.y;
    return transform;
  }

  static TextureWrap ConvertWrap(aiTextureMapMode mode) {
    if (mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal) return TextureWrap::kClamp;
    return mode == aiTextureMapMode_Mirror ? TextureWrap::kMirror : TextureWrap::kRepeat;
  }

  // Index of a texture in the mesh; decodes each file once. -1, with a warning, if it cannot be decoded.
  int TextureIndex(const std::string& name) {
    const auto [place, is_new] = texture_indices_.try_emplace(name, -1);
    if (!is_new) return place->second;
    auto image = ReadTexture(name);
    if (!image) {
      loaded_.warnings.push_back("texture left out: " + ShortText(image.error().message));
      return -1;
    }
    mesh().textures.push_back(*std::move(image));
    place->second = static_cast<int>(mesh().textures.size()) - 1;
    return place->second;
  }

  [[nodiscard]] Expected<cv::Mat> ReadTexture(const std::string& name) const {
    if (const aiTexture* embedded = scene_.GetEmbeddedTexture(name.c_str())) {
      if (embedded->mHeight != 0)
        return Fail(ErrorCode::kUnsupported, name + ": raw pixels; must be a PNG or JPEG image");
      const auto* bytes = reinterpret_cast<const std::byte*>(embedded->pcData);
      return DecodeTexture(std::span(bytes, embedded->mWidth), name);
    }
    VICTORIOUS_ASSIGN_OR_RETURN(const std::string bytes, folder_.Read(name));
    return DecodeTexture(std::as_bytes(std::span(bytes)), name);
  }

  [[nodiscard]] bool TextureHasAlpha(const Material& material) const {
    if (material.texture < 0) return false;
    const cv::Mat& bgra = loaded_.mesh.textures[static_cast<std::size_t>(material.texture)];
    return std::any_of(bgra.begin<cv::Vec4b>(), bgra.end<cv::Vec4b>(), [](const cv::Vec4b& p) { return p[3] != 255; });
  }

  // Exporters write opacity either way round (`Tr` of OBJ, transparency of COLLADA); nobody draws an invisible object.
  void ShowIfInvisible() {
    const auto is_invisible = [&](const MeshPart& part) {
      return mesh().materials[static_cast<std::size_t>(part.material)].base_colour.w() <= 0;
    };
    if (IsGltf() || mesh().parts.empty() || !std::ranges::all_of(mesh().parts, is_invisible)) return;
    for (Material& material : mesh().materials) material.base_colour.w() = 1;
    loaded_.warnings.emplace_back("all of it would be invisible: taken as opaque");
  }

  // Many exporters mark every material as blended. Opaque ones do not need depth sorting.
  void SetOpaqueIfNoAlpha(Material& material) const {
    const bool see_through = material.base_colour.w() < 1 || !loaded_.mesh.colours.empty() || TextureHasAlpha(material);
    if (material.alpha_mode == AlphaMode::kBlend && !see_through) material.alpha_mode = AlphaMode::kOpaque;
  }

  Status AddPart(int material) {
    const auto first = static_cast<std::uint32_t>(mesh().triangles.size());
    for (const PlacedMesh& placed : placed_) {
      if (std::cmp_not_equal(placed.mesh->mMaterialIndex, material)) continue;
      if (mesh().triangles.size() + placed.mesh->mNumFaces > kMaxTriangles ||
          mesh().positions.size() + placed.mesh->mNumVertices > 3 * kMaxTriangles) {
        return Fail(ErrorCode::kUnsupported, fmt::format("more than {} triangles: simplify the model", kMaxTriangles));
      }
      AddVertices(placed, uv_sources_[static_cast<std::size_t>(material)]);
      AddTriangles(placed);
    }
    const auto count = static_cast<std::uint32_t>(mesh().triangles.size()) - first;
    if (count > 0) mesh().parts.push_back({material, first, count});
    return {};
  }

  void AddVertices(const PlacedMesh& placed, const UvSource& uv_source) {
    const aiMesh& source = *placed.mesh;
    first_vertex_ = mesh().positions.size();
    aiMatrix3x3 normal_matrix(placed.file_from_mesh);
    normal_matrix.Inverse().Transpose();
    // 3DS files have no normals; those that the importer makes are smoothed over every edge.
    const bool has_normals = source.HasNormals() && format_ != CadFormat::k3ds;
    const bool has_uv =
        uv_source.channel < AI_MAX_NUMBER_OF_TEXTURECOORDS && source.HasTextureCoords(uv_source.channel);
    for (unsigned i = 0; i < source.mNumVertices; ++i) {
      const aiVector3D position = placed.file_from_mesh * source.mVertices[i];
      mesh().positions.emplace_back(position.x, position.y, position.z);
      const aiVector3D normal = has_normals ? normal_matrix * source.mNormals[i] : aiVector3D();
      mesh().normals.push_back(UnitOrZero({normal.x, normal.y, normal.z}));
      const aiVector3D from_below = has_uv ? source.mTextureCoords[uv_source.channel][i] : aiVector3D(0, 1, 0);
      const Eigen::Vector2f uv = uv_source.transform * Eigen::Vector2f(from_below.x, 1 - from_below.y);
      mesh().uvs.push_back(uv.allFinite() ? uv : Eigen::Vector2f(Eigen::Vector2f::Zero()));
    }
    AddColours(source);
  }

  // OBJ files have vertex colours of 0 to 1, or of 0 to 255.
  [[nodiscard]] float ColourScale(const aiMesh& source) const {
    const std::span colours(source.mColors[0], source.mNumVertices);
    const bool is_of_bytes = format_ == CadFormat::kObj && std::ranges::any_of(colours, [](const aiColor4D& colour) {
                               return std::max({colour.r, colour.g, colour.b}) > 1;
                             });
    return is_of_bytes ? 1.0F / 255 : 1.0F;
  }

  void AddColours(const aiMesh& source) {
    if (!source.HasVertexColors(0)) {
      if (!mesh().colours.empty()) mesh().colours.resize(mesh().positions.size(), Eigen::Vector4f::Ones());
      return;
    }
    mesh().colours.resize(first_vertex_, Eigen::Vector4f::Ones());
    const float scale = ColourScale(source);
    for (unsigned i = 0; i < source.mNumVertices; ++i) {
      const aiColor4D colour(scale * source.mColors[0][i].r, scale * source.mColors[0][i].g,
                             scale * source.mColors[0][i].b, source.mColors[0][i].a);
      const auto linear = [&](float value) {
        return IsGltf() ? ClampToUnit(value) : LinearFromSrgb(ClampToUnit(value));
      };
      mesh().colours.emplace_back(linear(colour.r), linear(colour.g), linear(colour.b), ClampToUnit(colour.a));
    }
  }

  static Eigen::Vector3f UnitOrZero(const Eigen::Vector3f& vector) {
    const float length = vector.norm();
    return std::isfinite(length) && length > 1e-20F ? Eigen::Vector3f(vector / length) : Eigen::Vector3f::Zero();
  }

  void AddTriangles(const PlacedMesh& placed) {
    const bool mirrored = placed.file_from_mesh.Determinant() < 0;
    for (unsigned i = 0; i < placed.mesh->mNumFaces; ++i) {
      const aiFace& face = placed.mesh->mFaces[i];
      if (face.mNumIndices < 3) continue;  // a point or a line
      const bool whole =
          face.mNumIndices == 3 && std::all_of(face.mIndices, face.mIndices + 3, [&](unsigned corner) {
            return corner < placed.mesh->mNumVertices && mesh().positions[first_vertex_ + corner].allFinite();
          });
      if (!whole) {
        ++broken_triangles_;
        continue;
      }
      const auto index = [&](int corner) { return static_cast<std::uint32_t>(first_vertex_ + face.mIndices[corner]); };
      mesh().triangles.push_back({index(0), index(mirrored ? 2 : 1), index(mirrored ? 1 : 2)});
    }
  }

  void AddWarnings() {
    if (broken_triangles_ == 0) return;
    loaded_.warnings.push_back(
        fmt::format("{} triangles left out: a vertex is missing or not finite", broken_triangles_));
  }

  const aiScene& scene_;
  const CadFolder& folder_;
  CadFormat format_;
  LoadedMesh loaded_;
  std::vector<PlacedMesh> placed_;
  std::vector<UvSource> uv_sources_;  // by material
  std::map<std::string, int> texture_indices_;
  std::size_t first_vertex_ = 0;  // of the mesh instance that is being added
  std::size_t broken_triangles_ = 0;
};

// The <up_axis> of a COLLADA file; Y if not given.
Axis ColladaUp(const CadFolder& folder) {
  const auto text = folder.Read(folder.name());
  if (!text) return Axis::kPlusY;
  if (text->find("<up_axis>Z_UP") != std::string::npos) return Axis::kPlusZ;
  return text->find("<up_axis>X_UP") != std::string::npos ? Axis::kPlusX : Axis::kPlusY;
}

// assimp rotates 3DS scenes from Z up to Y up; this undoes it.
void Undo3dsRotation(Mesh& mesh) {
  const auto turn = [](Eigen::Vector3f& v) { v = Eigen::Vector3f(v.x(), -v.z(), v.y()); };
  std::ranges::for_each(mesh.positions, turn);
  std::ranges::for_each(mesh.normals, turn);
}

Axis DefaultUpAxis(CadFormat format, const CadFolder& folder) {
  switch (format) {
    case CadFormat::kCollada:
      return ColladaUp(folder);
    case CadFormat::k3ds:
    case CadFormat::kPly:
    case CadFormat::kStl:
      return Axis::kPlusZ;
    default:
      return Axis::kPlusY;
  }
}

}  // namespace

std::optional<CadFormat> CadFormatFromName(std::string_view name) {
  static constexpr auto kExtensions = std::to_array<EnumText<CadFormat>>({{CadFormat::kGltf, ".gltf"},
                                                                          {CadFormat::kGltf, ".glb"},
                                                                          {CadFormat::kObj, ".obj"},
                                                                          {CadFormat::kAc3d, ".ac"},
                                                                          {CadFormat::kCollada, ".dae"},
                                                                          {CadFormat::k3ds, ".3ds"},
                                                                          {CadFormat::kPly, ".ply"},
                                                                          {CadFormat::kStl, ".stl"}});
  return FromText(kExtensions, LowerCase(std::filesystem::path(name).extension().string()));
}

Expected<ImportedMesh> ImportMesh(const CadFolder& folder, CadFormat format) {
  VICTORIOUS_ASSIGN_OR_RETURN(ReadableFile readable, MakeReadable(folder, format));
  const CadFolder files = readable.rewritten ? folder.WithBytes(std::as_bytes(std::span(*readable.rewritten))) : folder;
  Assimp::Importer importer;
  importer.SetIOHandler(new CadFolderIo(files));  // the importer takes ownership
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* scene = nullptr;
  try {
    scene = importer.ReadFile(folder.name(), aiProcess_Triangulate | aiProcess_SortByPType);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& exception) {
    return Fail(ErrorCode::kDataLoss, fmt::format("damaged: {}", ShortText(exception.what())));
  }
  if (scene == nullptr) {
    return Fail(ErrorCode::kDataLoss, fmt::format("damaged, or not of the format of its extension: {}",
                                                  ShortText(importer.GetErrorString())));
  }
  ImportedMesh imported{.up = DefaultUpAxis(format, folder)};
  VICTORIOUS_ASSIGN_OR_RETURN(imported.loaded, SceneConverter(*scene, files, format).Convert());
  std::vector<std::string>& warnings = imported.loaded.warnings;
  std::ranges::transform(readable.warnings, std::inserter(warnings, warnings.begin()), ShortText);
  if (format == CadFormat::k3ds) Undo3dsRotation(imported.loaded.mesh);
  return imported;
}

}  // namespace victorious
