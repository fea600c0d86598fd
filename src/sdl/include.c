/* #include, and the search for files.
 *
 * A file is cut into tokens once, however often it is included.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include "base/file.h"
#include "base/hash.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

/* --- where a file may be ------------------------------------------------------------------- */

/* Join a folder ("" for none) and a name; returns false when the path is too long. */
static bool join(char out[PATH_MAX_BYTES], const char *folder, const char *name)
{
    size_t length = strlen(folder);
    const char *slash = length && folder[length - 1] != '/' ? "/" : "";
    int wrote = snprintf(out, PATH_MAX_BYTES, "%s%s%s", folder, slash, name);
    return wrote >= 0 && wrote < PATH_MAX_BYTES;
}

/* Return the folder of a path with its slash, in `out`. */
static const char *folder_of(char out[PATH_MAX_BYTES], const char *path)
{
    size_t length = (size_t)(path_base(path) - path);
    if (length >= PATH_MAX_BYTES)
        length = 0;
    memcpy(out, path, length);
    out[length] = 0;
    return out;
}

/* Put the folder beside the program into `out`: `relative` to where the program lies. */
static const char *program_folder(char out[PATH_MAX_BYTES], const char *relative)
{
    char program[PATH_MAX_BYTES], folder[PATH_MAX_BYTES];
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    out[0] = 0;
    if (length <= 0)
        return out;
    program[length] = 0;
    if (!join(out, folder_of(folder, program), relative))
        out[0] = 0;
    return out;
}

const char *sdl_own_folder(int i, char out[FILE_PATH_MAX])
{
    switch (i) {
    case 0:
        return program_folder(out, "../../stdlib");
    case 1:
        return program_folder(out, "../share/pms");
    case 2:
        return PMS_DATA_DIR;
    default:
        return NULL;
    }
}

/* Return the i-th folder of the search order, "" for the current one; NULL: skip it.  *is_last
 * is set past the end. */
static const char *search_folder(Parser *p, int i, char out[PATH_MAX_BYTES], bool *is_last)
{
    int libraries = p->options->library_path_count;
    *is_last = false;
    if (i == 0)
        return "";
    if (i == 1)
        return folder_of(out, p->frame_count ? frame_top(p)->file->source->path : "");
    if (i < 2 + libraries)
        return p->options->library_paths[i - 2];
    const char *own = sdl_own_folder(i - 2 - libraries, out);
    *is_last = !own;
    return own;
}

/* Replace the last component of `path` by the name of a file that differs only in case; of
 * several the first by their bytes, whatever order the folder has. */
static bool match_case(char path[PATH_MAX_BYTES])
{
    char folder[PATH_MAX_BYTES], best[PATH_MAX_BYTES] = "";
    char *base = path + (path_base(path) - path);
    folder_of(folder, path);
    DIR *dir = opendir(folder[0] ? folder : ".");
    for (struct dirent *entry; dir && (entry = readdir(dir));)
        if (strcasecmp(entry->d_name, base) == 0 && (!best[0] || strcmp(entry->d_name, best) < 0))
            memcpy(best, entry->d_name, strlen(base) + 1);
    if (dir)
        closedir(dir);
    if (best[0])
        strcpy(base, best);
    return best[0] != 0;
}

/* Look for one spelling of the name in every folder; returns the path in `out`. */
static bool find_spelling(Parser *p, const char *name, bool is_any_case, char out[PATH_MAX_BYTES])
{
    bool is_last;
    char place[PATH_MAX_BYTES];
    for (int i = 0;; i++) {
        const char *folder = search_folder(p, i, place, &is_last);
        if (is_last)
            return false;
        if (!folder || !join(out, folder, name))
            continue;
        if (is_any_case ? match_case(out) && file_exists(out) : file_exists(out))
            return true;
        if (name[0] == '/')
            return false;
    }
}

static bool ends_with(const char *name, const char *extension)
{
    size_t length = strlen(name), tail = strlen(extension);
    return length >= tail && strcmp(name + length - tail, extension) == 0;
}

/* Try the name with each extension, and bare: first when it has one, last when it has none. */
static bool find_name(Parser *p, const char *name, const char *const *extensions, bool is_any_case,
                      char out[PATH_MAX_BYTES])
{
    bool has_extension = false;
    for (int i = 0; extensions && extensions[i]; i++)
        has_extension = has_extension || ends_with(name, extensions[i]);
    if (has_extension && find_spelling(p, name, is_any_case, out))
        return true;
    for (int i = 0; extensions && extensions[i]; i++) {
        char longer[PATH_MAX_BYTES];
        int length = snprintf(longer, sizeof longer, "%s%s", name, extensions[i]);
        if (length < PATH_MAX_BYTES && find_spelling(p, longer, is_any_case, out))
            return true;
    }
    return !has_extension && find_spelling(p, name, is_any_case, out);
}

const char *file_find(Parser *p, const char *name, const char *const *extensions)
{
    char path[PATH_MAX_BYTES], slashed[PATH_MAX_BYTES];
    if (strlen(name) >= sizeof slashed)
        return NULL;
    bool is_found = find_name(p, name, extensions, false, path);
    strcpy(slashed, name);
    for (char *c = slashed; *c; c++)
        if (*c == '\\')
            *c = '/';
    if (!is_found && strcmp(slashed, name) != 0)
        is_found = find_name(p, slashed, extensions, false, path);
    if (!is_found && extensions && find_name(p, slashed, extensions, true, path)) {
        is_found = true;
        parse_warn(p, WARN_FILE, p->last, "'%s' is not there, taking '%s'", name, path);
    }
    return is_found ? parse_copy(p, path, strlen(path) + 1) : NULL;
}

/* --- opening ------------------------------------------------------------------------------- */

static TokenFile *file_load(Parser *p, const char *path)
{
    Arena *text = p->scene->text;
    Source *source = parse_no_null(p, ARENA_NEW(text, Source));
    source->path = parse_no_null(p, arena_strndup(text, path, strlen(path)));
    Status status = file_read(p->diag, path, SOURCE_SIZE_MAX, text, &source->text, &source->size);
    if (status != OK)
        parse_fail_status(p, status);
    return file_lex(p, source);
}

TokenFile *file_lex(Parser *p, const Source *source)
{
    TokenFile *file = parse_no_null(p, ARENA_NEW(p->arena, TokenFile));
    uint64_t hash = hash_bytes(p->scene->text_hash, &source->size, sizeof source->size);
    p->scene->text_hash = hash_bytes(hash, source->text, source->size);
    Status status = lex_source(p->diag, source, &p->names, p->arena, file);
    if (status != OK)
        parse_fail_status(p, status);
    if (strmap_set(&p->files, source->path, strlen(source->path), file) != 0)
        parse_fail_memory(p);
    return file;
}

/* A file may include itself behind a condition, but not for ever. */
static void check_cycle(Parser *p, const TokenFile *file, Span call)
{
    int open = 0;
    for (int i = 0; i < p->frame_count; i++)
        open += p->frames[i].file == file && !p->frames[i].macro;
    if (open >= INCLUDE_SELF_MAX)
        parse_fail(p, call, "include cycle: '%s' includes itself again and again",
                   file->source->path);
    if (p->include_depth == INCLUDE_DEPTH_MAX)
        parse_fail(p, call, "includes nest too deep (limit %d)", INCLUDE_DEPTH_MAX);
}

void file_open(Parser *p, const char *path, Span call)
{
    TokenFile *file = strmap_find(&p->files, path, strlen(path));
    if (!file)
        file = file_load(p, path);
    check_cycle(p, file, call);
    if (p->frame_count > 0)
        p->include_depth++;
    frame_push_file(p, file, call);
}

/* --- what to say of POV-Ray's own files ----------------------------------------------------- */

/* Return true, with the folder in *folder, if an include of this name lies in one of POV-Ray's. */
static bool find_povray_folder(Parser *p, const char *name, const char **folder)
{
    static const char *const usual[] = {"/usr/share/povray-3.7/include",
                                        "/usr/local/share/povray-3.7/include", NULL};
    static const char *const endings[] = {"", ".inc"};
    const char *const *folders = p->options->povray_folders;
    for (folders = folders ? folders : usual; name[0] != '/' && *folders; folders++)
        for (int i = 0; i < 2; i++) {
            char path[PATH_MAX_BYTES];
            int length = snprintf(path, sizeof path, "%s/%s%s", *folders, name, endings[i]);
            *folder = *folders;
            if (length < PATH_MAX_BYTES && file_exists(path))
                return true;
        }
    return false;
}

/* Return true for the name of an include file that comes with POV-Ray. */
static bool is_povray_include(const char *name)
{
    static const char *const names[] = {
        "arrays",   "chars",     "colors",     "consts",   "debug",   "finish",     "functions",
        "glass",    "golds",     "ior",        "logo",     "math",    "metals",     "rad_def",
        "rand",     "screen",    "shapes",     "shapes2",  "shapes3", "skies",      "stage1",
        "stars",    "stdcam",    "stdinc",     "stones",   "stones1", "stones2",    "strings",
        "sunpos",   "textures",  "woods",      "woodmaps", "shapesq", "transforms", "meshmaker",
        "stoneold", "glass_old", "shapes_old", "makegrass"};
    size_t length = strlen(name);
    if (ends_with(name, ".inc"))
        length -= strlen(".inc");
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strlen(names[i]) == length && memcmp(names[i], name, length) == 0)
            return true;
    return false;
}

static noreturn void fail_not_found(Parser *p, Span span, const char *name)
{
    static const char message[] =
        "cannot find '%s' in the current folder, beside this file or on the library path%s%s%s%s";
    const char *folder;
    if (find_povray_folder(p, name, &folder))
        parse_fail(p, span, message, name, "; POV-Ray's own is in '", folder,
                   "', and found with -L ", folder);
    if (is_povray_include(name))
        parse_fail(p, span, message, name,
                   "; it is one of POV-Ray's own, which the package povray-includes has", "", "",
                   "");
    parse_fail(p, span, message, name, "", "", "", "");
}

void include_directive(Parser *p)
{
    static const char *const extensions[] = {".inc", ".INC", NULL};
    Span word = p->last, begin = parse_peek(p)->span;
    const char *name = parse_path(p);
    const char *path = file_find(p, name, extensions);
    if (!path)
        fail_not_found(p, span_join(begin, p->last), name);
    file_open(p, path, span_join(word, p->last));
}
