// The vertices of a mesh.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
out vec3 surface_position;
out vec3 surface_normal;
uniform mat4 to_clip;

void main() {
    surface_position = position;
    surface_normal = normal;
    gl_Position = to_clip * vec4(position, 1.0);
}
