// glTF 2 and GLB through assimp. All of its importers but the one wanted are unregistered, and it is given the bytes
// that a guard has checked, never the file system.
//
// The importer of Debian 12 (assimp 5.2.5) has memory faults that are not fixed in this version (overflows in accessors
// and nodes, endless recursion); it gets a document that gltf_guard has rewritten. The guard does not look into the
// buffers: positions are checked by clean; faces whose indices are out of range the importer drops itself, without a
// count. All other formats have readers of their own: assimp's hang (PLY), write beyond their heap blocks (OBJ), or
// need a check of the whole file that is a reader already (STL, OFF). COLLADA (crashes and gigabytes on 8 of 400,
// recursion without end) and 3MF (aborts on 53 of 400) are not read.
#include <assimp/BaseImporter.h>
#include <assimp/importerdesc.h>
#include <assimp/scene.h>

#include <Eigen/Core>
#include <algorithm>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
#include <assimp/Importer.hpp>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <utility>

#include "raycast/mesh_files/face_writer.hpp"
#include "raycast/mesh_files/gltf_guard.hpp"
#include "raycast/mesh_files/readers.hpp"

namespace nearpose {
namespace {

class MemoryStream : public Assimp::IOStream {
  public:
    // Of bytes that live longer.
    explicit MemoryStream(std::string_view bytes) : bytes_(bytes) {}
    // Of bytes that it keeps.
    explicit MemoryStream(std::string&& bytes) : owned_(std::move(bytes)), bytes_(owned_) {}

    size_t Read(void* buffer, size_t size, size_t count) override {
        if (size == 0) return 0;
        const std::size_t items = std::min(count, (bytes_.size() - position_) / size);
        std::memcpy(buffer, bytes_.data() + position_, items * size);
        position_ += items * size;
        return items;
    }
    size_t Write(const void*, size_t, size_t) override { return 0; }
    aiReturn Seek(size_t offset, aiOrigin origin) override {
        const std::size_t base = origin == aiOrigin_CUR ? position_ : origin == aiOrigin_END ? bytes_.size() : 0;
        // A negative offset arrives as a huge one and wraps around.
        const std::size_t target = base + offset;
        if (target > bytes_.size()) return aiReturn_FAILURE;
        position_ = target;
        return aiReturn_SUCCESS;
    }
    size_t Tell() const override { return position_; }
    size_t FileSize() const override { return bytes_.size(); }
    void Flush() override {}

  private:
    std::string owned_;
    std::string_view bytes_;
    std::size_t position_ = 0;
};

// Opens `document` under `name`, and under any other name regular files of `folder`, for reading.
class GuardedFiles : public Assimp::IOSystem {
  public:
    GuardedFiles(std::string name, std::string_view document, const std::filesystem::path& folder,
                 std::uint64_t max_bytes)
        : name_(std::move(name)), document_(document), folder_(folder), max_bytes_(max_bytes) {}

    bool Exists(const char* file) const override { return file == name_ || is_buffer(file); }
    char getOsSeparator() const override { return '/'; }
    Assimp::IOStream* Open(const char* file, const char* mode) override {
        if (mode == nullptr || mode[0] != 'r') return nullptr;
        if (file == name_) return std::make_unique<MemoryStream>(document_).release();
        if (!is_buffer(file)) return nullptr;
        return std::make_unique<MemoryStream>(read_regular_file(folder_ / file, max_bytes_)).release();
    }
    void Close(Assimp::IOStream* stream) override { const std::unique_ptr<Assimp::IOStream> owner(stream); }

  private:
    bool is_buffer(const char* file) const { return is_own_file(folder_, file); }

    std::string name_;
    std::string_view document_;
    const std::filesystem::path& folder_;
    std::uint64_t max_bytes_;
};

// Every other importer would be tried too where a file's name or content says so.
void keep_alone(std::string_view wanted, Assimp::Importer& importer) {
    for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
        if (importer.GetImporterInfo(i)->mName == wanted) continue;
        const std::unique_ptr<Assimp::BaseImporter> removed(importer.GetImporter(i));
        importer.UnregisterLoader(removed.get());
    }
    if (importer.GetImporterCount() != 1) {
        throw std::runtime_error("this build of assimp has no " + std::string(wanted));
    }
}

void append_mesh(const aiMesh& part, const aiMatrix4x4& object_from_mesh, const std::string& source,
                 const MeshLimits& limits, Mesh& mesh, FaceWriter& faces) {
    const std::size_t first = mesh.vertices_in_object.size();
    if (first + part.mNumVertices > 3 * static_cast<std::size_t>(limits.max_triangles)) {
        throw std::runtime_error(source + ": more vertices than the limit of " +
                                 std::to_string(3 * limits.max_triangles));
    }
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
        const aiVector3D vertex = object_from_mesh * part.mVertices[v];
        mesh.vertices_in_object.emplace_back(vertex.x, vertex.y, vertex.z);
    }
    std::vector<int> corners;
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
        const aiFace& face = part.mFaces[f];
        corners.clear();
        for (unsigned k = 0; k < face.mNumIndices; ++k) {
            const bool exists = face.mIndices[k] < part.mNumVertices;
            corners.push_back(exists ? static_cast<int>(first + face.mIndices[k]) : -1);
        }
        faces.add(corners);
    }
}

// The meshes of all nodes in object axes; the guard has limited how many nodes there are.
Mesh flatten(const aiScene& scene, const std::string& source, const MeshLimits& limits, MeshRepair& repair) {
    Mesh mesh;
    FaceWriter faces(source, limits, mesh, repair);
    std::vector<std::pair<const aiNode*, aiMatrix4x4>> open{{scene.mRootNode, aiMatrix4x4()}};
    while (!open.empty()) {
        const auto [node, object_from_parent] = open.back();
        open.pop_back();
        const aiMatrix4x4 object_from_node = object_from_parent * node->mTransformation;
        for (unsigned m = 0; m < node->mNumMeshes; ++m) {
            append_mesh(*scene.mMeshes[node->mMeshes[m]], object_from_node, source, limits, mesh, faces);
        }
        for (unsigned c = node->mNumChildren; c-- > 0;) open.emplace_back(node->mChildren[c], object_from_node);
    }
    if (mesh.triangles.empty()) throw std::runtime_error(source + ": the file has no triangles");
    return mesh;
}

}  // namespace

Mesh read_gltf(std::string_view bytes, const std::string& source, const std::filesystem::path& folder,
               const MeshLimits& limits, MeshRepair& repair) {
    const bool is_glb = is_glb_file(bytes);
    const std::string document =
        is_glb ? checked_glb(bytes, source, folder, limits) : checked_gltf(bytes, 0, source, folder, limits);
    // A colon keeps the name apart from those that a buffer may have.
    const std::string name = is_glb ? "document:.glb" : "document:.gltf";
    Assimp::Importer importer;
    keep_alone("glTF2 Importer", importer);
    importer.SetIOHandler(new GuardedFiles(name, document, folder, limits.max_file_bytes));  // takes it over
    const aiScene* scene = importer.ReadFile(name, 0);
    if (scene == nullptr || scene->mRootNode == nullptr) {
        // The importer may quote the rest of the file.
        const std::string cause = std::string(importer.GetErrorString()).substr(0, 200);
        throw std::runtime_error(source + ": glTF: " + cause.substr(0, cause.find_first_of("\r\n")));
    }
    return flatten(*scene, source, limits, repair);
}

}  // namespace nearpose
