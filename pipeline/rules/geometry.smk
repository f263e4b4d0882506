# From the case to stones and their contacts.

if config["drawing"]:

    rule drawing:
        input:
            settings="geometry/{geometry}/settings.json",
            drawing=config["drawing"],
            sources=sources("dxf", "config", "io/vtu.py"),
        output:
            assemblage="geometry/{geometry}/assemblage.npz",
            vtu="geometry/{geometry}/stones.vtu",
        shell:
            STAGE + " drawing {wildcards.geometry:q} {input.settings:q} {input.drawing:q} {output.assemblage:q} {output.vtu:q}"

else:

    rule source:
        input:
            settings="geometry/{geometry}/settings.json",
            sources=sources("generators", "bond", "config", "io/building_json.py"),
        output:
            building="geometry/{geometry}/building.json",
        shell:
            STAGE + " source {wildcards.geometry:q} {input.settings:q} {output.building:q}"

    rule blocks:
        input:
            building="geometry/{geometry}/building.json",
            sources=sources(
                "stones/blocks.py",
                "geometry/manifolds.py",
                "shell_mesh/midplanes.py",
                "stones/pierced.py",
                "bond",
                "dxf",
                "io/building_json.py",
                "io/vtu.py",
            ),
        output:
            assemblage="geometry/{geometry}/assemblage.npz",
            dxf="geometry/{geometry}/stones.dxf",
            vtu="geometry/{geometry}/stones.vtu",
        shell:
            STAGE + " blocks {wildcards.geometry:q} {input.building:q} {output.assemblage:q} {output.dxf:q} {output.vtu:q}"


rule contacts:
    input:
        assemblage="geometry/{geometry}/assemblage.npz",
        sources=sources("stones/contacts.py", "geometry/manifolds.py", "shell_mesh/midplanes.py", "stones/soundness.py", "bond"),
    output:
        contacts="geometry/{geometry}/contacts.npz",
    shell:
        STAGE + " contacts {wildcards.geometry:q} {input.assemblage:q} {output.contacts:q}"
