#pragma once

#include <filesystem>
#include <string>

namespace raystudy {

/// Where the figures' npm packages are looked for: RAYSTUDY_VEGA, else `<user cache>/vega`; its node_modules holds vega and
/// vega-lite.
[[nodiscard]] std::filesystem::path vega_folder();

/// Why no figure can be drawn on this machine, with the command that mends it; empty where all is there: node, the npm packages,
/// and rsvg-convert for PNG.
[[nodiscard]] std::string vega_problem();

/// Draws the Vega-Lite specification in `spec` (NAME.vl.json) to NAME.svg and, with twice its size in pixels, NAME.png beside it.
/// Throws Error where something is missing (vega_problem), or with what node or rsvg-convert say.
void render_vega(const std::filesystem::path& spec);

}  // namespace raystudy
