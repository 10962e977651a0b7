// The vertices of a mesh, with TEXTURED also their texture coordinates.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
#ifdef TEXTURED
layout(location = 2) in vec2 texture_coordinates;
out vec2 surface_texture;
#endif
out vec3 surface_position;
out vec3 surface_normal;
uniform mat4 to_clip;

void main() {
    surface_position = position;
    surface_normal = normal;
#ifdef TEXTURED
    surface_texture = texture_coordinates;
#endif
    gl_Position = to_clip * vec4(position, 1.0);
}
