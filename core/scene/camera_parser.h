/// The camera of a scene file. Called by scene_parser.cpp alone.
#pragma once

#include "core/scene/json_cursor.h"

namespace raypool {

CameraDescription parse_camera(JsonObject object);

}  // namespace raypool
