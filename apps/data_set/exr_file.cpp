#include "apps/data_set/depth_readers.hpp"

#ifdef NEARPOSE_OPENEXR
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

#include <cstddef>
#include <cstdint>
#include <exception>

#include "apps/base/file_io.hpp"
#endif

namespace nearpose::data_set {

#ifdef NEARPOSE_OPENEXR
namespace {

// Z is what renderers and the format's own documents call depth.
std::string depth_channel(const Imf::ChannelList& channels, const DepthRequest& request) {
    std::string names;
    std::string only;
    int count = 0;
    for (auto channel = channels.begin(); channel != channels.end(); ++channel, ++count) {
        only = channel.name();
        names += (names.empty() ? "" : ", ") + only;
        if (only == "Z") return only;
    }
    if (count == 1) return only;
    throw request.error("has the channels " + names + "; depth must be the channel Z, or the only one");
}

NumberImage read_open(const DepthRequest& request) {
    Imf::InputFile file(request.path.c_str(), 0);  // in the caller's thread
    const Imath::Box2i window = file.header().dataWindow();
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide) {
        throw request.error("claims " + std::to_string(width) + " x " + std::to_string(height) + " pixels; at most " +
                            std::to_string(kMaxImageSide) + " a side are read");
    }
    const std::string channel = depth_channel(file.header().channels(), request);
    const Imf::Channel& described = file.header().channels()[channel];
    if (described.xSampling != 1 || described.ySampling != 1) throw request.error("leaves out pixels of its depth");
    NumberImage image{static_cast<int>(width), static_cast<int>(height), true, {}};
    request.check_size({image.width, image.height});
    if (!request.with_pixels) return image;
    image.values.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    Imf::FrameBuffer buffer;
    buffer.insert(channel, Imf::Slice::Make(Imf::FLOAT, image.values.data(), window, sizeof(float),
                                            sizeof(float) * static_cast<std::size_t>(width)));
    file.setFrameBuffer(buffer);
    file.readPixels(window.min.y, window.max.y);
    return image;
}

}  // namespace

NumberImage read_exr(const DepthRequest& request) {
    read_file_start(request.path, 1);  // refuses pipes and folders
    try {
        return read_open(request);
    } catch (const std::runtime_error&) {
        throw;  // ours
    } catch (const std::exception& error) {
        throw request.error(std::string("not a readable EXR: ") + error.what());
    }
}

#else

NumberImage read_exr(const DepthRequest& request) {
    throw request.error(
        "is an EXR, and this program was built without OpenEXR (third_party_notes/install_packages.sh "
        "images, then build anew); or convert it to 16-bit PNG or NPY");
}

#endif

}  // namespace nearpose::data_set
