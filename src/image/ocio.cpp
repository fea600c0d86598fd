/* Scene light to display colours, through OpenColorIO: the one C++ file.
 *
 * Each function of the C interface is one try block; no exception and no C++ type leaves this
 * file.  pms's own configuration is compiled in from stdlib/pms.ocio, so that it is there
 * wherever the program is.  SPDX-License-Identifier: Apache-2.0 */
extern "C" {
#include "image/ocio.h"
}

#include <OpenColorIO/OpenColorIO.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <new>
#include <sstream>
#include <string>

namespace OCIO = OCIO_NAMESPACE;

struct Ocio {
    OCIO::ConstConfigRcPtr config;
    std::string name;
};

namespace
{

/* stdlib/pms.ocio as a string literal, made by the Makefile. */
const char own_config[] =
#include "pms_ocio.inc"
    ;

/* A mistake of the user, in words for the user. */
struct UsageError {
    std::string message;
};

/* Call `body` and turn whatever it throws into a Status and a message. */
template <typename Body> Status guarded(Diag *diag, const char *what, Body body)
{
    try {
        body();
        return OK;
    } catch (const std::bad_alloc &) {
        return diag_no_memory(diag, what);
    } catch (const UsageError &e) {
        return diag_fail(diag, ERR_USAGE, "%s", e.message.c_str());
    } catch (const OCIO::ExceptionMissingFile &e) {
        return diag_fail(diag, ERR_FILE, "%s: %s", what, e.what());
    } catch (const OCIO::Exception &e) {
        return diag_fail(diag, ERR_LIBRARY, "%s: %s", what, e.what());
    } catch (const std::exception &e) {
        return diag_fail(diag, ERR_LIBRARY, "%s: %s", what, e.what());
    } catch (...) {
        return diag_fail(diag, ERR_INTERNAL, "%s: unknown exception", what);
    }
}

/* Warnings of the library are not for standard error of ours. */
void drop_message(const char *) {}

OCIO::ConstConfigRcPtr load_config(const char *path)
{
    OCIO::SetLoggingFunction(drop_message);
    OCIO::ConstConfigRcPtr config;
    if (path) {
        config = OCIO::Config::CreateFromFile(path);
    } else {
        std::istringstream stream(own_config);
        config = OCIO::Config::CreateFromStream(stream);
    }
    config->validate();
    return config;
}

template <typename NameAt> std::string join(int count, NameAt name_at)
{
    std::string list;
    for (int i = 0; i < count; i++)
        list += std::string(i ? ", '" : "'") + name_at(i) + "'";
    return list;
}

std::string find_display(const OCIO::ConstConfigRcPtr &config, const char *wanted)
{
    if (!wanted)
        return config->getDefaultDisplay();
    for (int i = 0; i < config->getNumDisplays(); i++) {
        if (std::strcmp(config->getDisplay(i), wanted) == 0)
            return wanted;
    }
    throw UsageError{std::string("unknown display '") + wanted + "'; known: " +
                     join(config->getNumDisplays(), [&](int i) { return config->getDisplay(i); })};
}

std::string find_view(const OCIO::ConstConfigRcPtr &config, const std::string &display,
                      const char *wanted)
{
    const char *d = display.c_str();
    if (!wanted)
        return config->getDefaultView(d);
    for (int i = 0; i < config->getNumViews(d); i++) {
        if (std::strcmp(config->getView(d, i), wanted) == 0)
            return wanted;
    }
    throw UsageError{
        std::string("unknown view '") + wanted + "' of display '" + display +
        "'; known: " + join(config->getNumViews(d), [&](int i) { return config->getView(d, i); })};
}

OCIO::ConstCPUProcessorRcPtr make_processor(const OCIO::ConstConfigRcPtr &config,
                                            const char *display, const char *view)
{
    std::string d = find_display(config, display);
    std::string v = find_view(config, d, view);
    OCIO::DisplayViewTransformRcPtr transform = OCIO::DisplayViewTransform::Create();
    transform->setSrc(OCIO::ROLE_SCENE_LINEAR);
    transform->setDisplay(d.c_str());
    transform->setView(v.c_str());
    /* Not the library's default: that one takes powers by approximation, which shows as a step
     * in 16-bit files. */
    return config->getProcessor(transform)->getOptimizedCPUProcessor(OCIO::OPTIMIZATION_LOSSLESS);
}

/* The library takes sizes as long; feed it lines of a size that never overflows. */
void apply_pixels(const OCIO::ConstCPUProcessorRcPtr &processor, float *pixels, size_t count,
                  int channels)
{
    const size_t line = 1 << 16;
    for (size_t done = 0; done < count; done += line) {
        long width = static_cast<long>(std::min(line, count - done));
        OCIO::PackedImageDesc image(pixels + done * static_cast<size_t>(channels), width, 1,
                                    channels);
        processor->apply(image);
    }
}

bool contains_srgb(const char *text)
{
    std::string lower;
    for (const char *c = text; *c; c++)
        lower += static_cast<char>(*c >= 'A' && *c <= 'Z' ? *c - 'A' + 'a' : *c);
    return lower.find("srgb") != std::string::npos;
}

bool names_srgb(const OCIO::ConstConfigRcPtr &config, const char *display, const char *view)
{
    std::string d = find_display(config, display);
    std::string v = find_view(config, d, view);
    std::string space = config->getDisplayViewColorSpaceName(d.c_str(), v.c_str());
    if (space == OCIO::OCIO_VIEW_USE_DISPLAY_NAME)
        space = d;
    OCIO::ConstColorSpaceRcPtr found = config->getColorSpace(space.c_str());
    bool is_light = found && std::strcmp(found->getEncoding(), "scene-linear") == 0;
    return found && !found->isData() && !is_light && contains_srgb(found->getName());
}

} // namespace

extern "C" Status ocio_new(Diag *diag, const char *config, Ocio **out)
{
    *out = nullptr;
    const char *path = config ? config : std::getenv("OCIO");
    if (path && !*path)
        path = nullptr;
    return guarded(diag, path ? path : "pms.ocio", [&] {
        OCIO::ConstConfigRcPtr loaded = load_config(path);
        *out = new Ocio{loaded, path ? path : "built in"};
    });
}

extern "C" void ocio_free(Ocio *ocio)
{
    delete ocio;
}

extern "C" Status ocio_apply(Diag *diag, const Ocio *ocio, const char *display, const char *view,
                             float *pixels, size_t count, int channels)
{
    return guarded(diag, ocio->name.c_str(), [&] {
        apply_pixels(make_processor(ocio->config, display, view), pixels, count, channels);
    });
}

extern "C" bool ocio_is_srgb(const Ocio *ocio, const char *display, const char *view)
{
    try {
        return names_srgb(ocio->config, display, view);
    } catch (...) {
        return false;
    }
}

extern "C" const char *ocio_name(const Ocio *ocio)
{
    return ocio->name.c_str();
}
