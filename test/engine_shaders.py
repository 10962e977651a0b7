"""Shaders for engines that no test runs compile with mock declarations of the engines' names: python3 test/engine_shaders.py GLSLANG.

The stand-ins have the types that the engines' documentation gives. URP's Light lacks its direction, which is `half`. The shader for Unity
is compiled by its passes and stages, as HLSL; that for Godot as GLSL. test/hosts/drawn_engine_shaders.py runs both.
"""
import os
import re
import subprocess
import sys
import tempfile

root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
URP = """
#ifndef UNITY
#define UNITY
#define PI 3.14159265359
#define MAX_VISIBLE_LIGHTS 256
#define URP_FP_DIRECTIONAL_LIGHTS_COUNT 1u
#define CBUFFER_START(name) cbuffer name : register(b1) {
#define CBUFFER_END };
#define LIGHT_LOOP_BEGIN(count) for (uint lightIndex = 0u; lightIndex < count; ++lightIndex) {
#define LIGHT_LOOP_END }
struct InputData { float3 positionWS; float2 normalizedScreenSpaceUV; };
#define _MainLightPosition _WorldSpaceLightPos0
static float4 _AdditionalLightsPosition[1];
struct Light { half3 color; float distanceAttenuation; half shadowAttenuation; };
cbuffer Unity : register(b0) {
    float4x4 unity_ObjectToWorld, unity_MatrixVP, unity_WorldToShadow;
    float4 unity_SpecCube0_HDR, unity_FogColor, unity_Ambient, _WorldSpaceLightPos0, _LightColor0;
    float3 _WorldSpaceCameraPos;
    float unity_Lights;
};
TextureCube unity_SpecCube0 : register(t1);
SamplerState samplerunity_SpecCube0 : register(s2);
float3 TransformObjectToWorld(float3 p) { return mul(unity_ObjectToWorld, float4(p, 1)).xyz; }
float4 TransformWorldToHClip(float3 p) { return mul(unity_MatrixVP, float4(p, 1)); }
float3 TransformObjectToWorldNormal(float3 n) { return mul((float3x3)unity_ObjectToWorld, n); }
float4 TransformWorldToShadowCoord(float3 p) { return mul(unity_WorldToShadow, float4(p, 1)); }
float3 GetWorldSpaceViewDir(float3 p) { return _WorldSpaceCameraPos - p; }
float2 GetNormalizedScreenSpaceUV(float4 p) { return p.xy; }
float ComputeFogFactor(float z) { return z; }
float3 MixFog(float3 colour, float fog) { return lerp(unity_FogColor.rgb, colour, saturate(fog)); }
half3 SampleSH(half3 n) { return unity_Ambient.rgb; }
half3 GlossyEnvironmentReflection(half3 direction, half roughness, half occlusion) {
    return unity_SpecCube0.SampleLevel(samplerunity_SpecCube0, direction, 6 * roughness).rgb * occlusion;
}
Light GetMainLight(float4 shadow) {
    Light light;
    light.color = _LightColor0.rgb, light.distanceAttenuation = 1, light.shadowAttenuation = 1 + 0 * shadow.x;
    return light;
}
Light GetAdditionalLight(uint i, float3 p, half4 mask) { return GetMainLight(float4(p, i)); }
int GetPerObjectLightIndex(uint i) { return int(i); }
uint GetAdditionalLightsCount() { return uint(unity_Lights); }
#endif
"""
INCLUDED = [f"Packages/com.unity.render-pipelines.universal/ShaderLibrary/{name}.hlsl" for name in ("Core", "Lighting")]
GODOT = """#version 330
vec3 ALBEDO, DIFFUSE_LIGHT, SPECULAR_LIGHT = vec3(0.0);
float SPECULAR, METALLIC, ROUGHNESS, ATTENUATION = 1.0;
in vec3 NORMAL, VIEW, LIGHT, LIGHT_COLOR;
layout(location = 0) out vec4 lamp;
layout(location = 1) out vec4 albedo;
"""


def compile_text(glslang, path, text, *options):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    done = subprocess.run([glslang, *options, path], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        sys.exit(f"{path}\n{done.stdout}")


def read(*path):
    with open(os.path.join(root, *path), encoding="utf-8") as file:
        return file.read()


def compile_unity(glslang, work):
    """Compiles each stage of each pass, to work/passI.STAGE.spv, and returns the number of passes."""
    for name in INCLUDED:
        os.makedirs(os.path.dirname(os.path.join(work, name)), exist_ok=True)
        with open(os.path.join(work, name), "w", encoding="utf-8") as file:
            file.write(URP)
    passes = re.findall(r"^ *HLSLPROGRAM\n(.*?)^ *ENDHLSL", read("data", "ready", "film.shader"), flags=re.M | re.S)
    for i, pass_text in enumerate(passes):
        for stage, pragma in (("vert", "#pragma vertex vert"), ("frag", "#pragma fragment frag")):
            assert pragma in pass_text
            path = os.path.join(work, f"pass{i}.{stage}")
            for keyword in ["", *sorted(set(re.findall("_FORWARD_PLUS|_MAIN_LIGHT_SHADOWS_SCREEN", pass_text)))]:
                define = f"#define {keyword}\n" if keyword else ""
                compile_text(glslang, path + ".hlsl", "#extension GL_GOOGLE_include_directive : enable\n" + define + pass_text, "-D", "-V", "-S", stage,
                             "-e", stage, "-o", path + ("2" if keyword else "") + ".spv", f"-I{work}")
    return len(passes)


def godot_text():
    """A fragment shader whose outputs are the light of a lamp and ALBEDO. Only Godot can tell what its language lacks of GLSL."""
    text = read("examples", "hosts", "godot4", "film.gdshader").replace("shader_type spatial;", "").replace(" : source_color", "")
    text = text.replace('#include "film.gdshaderinc"', read("examples", "hosts", "godot4", "film.gdshaderinc"))
    return GODOT + text + "void main() {\n    fragment();\n    light();\n    lamp = vec4(SPECULAR_LIGHT, 1.0);\n    albedo = vec4(ALBEDO, 1.0);\n}\n"


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as work:
        print(f"Unity: {compile_unity(sys.argv[1], work)} passes compile")
        compile_text(sys.argv[1], os.path.join(work, "film.frag"), godot_text())
        print("Godot 4: compiles")
