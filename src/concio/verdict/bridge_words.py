"""Sentences of the verdict of a bridge, in English and Italian."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Literal

from concio.display import Units, number

Language = Literal["en", "it"]

ENGLISH: Mapping[str, str] = {
    "asked": "{required} times the vehicle '{vehicle}' ({loads}) at every position on the bridge, while all other "
    "loads act with factor 1",
    "loads_axles": "heaviest axle {axle}, {total} in all",
    "loads_both": "heaviest axle {axle}, {total} in axles, and a uniform load of up to {uniform} along the road",
    "loads_uniform": "a uniform load of up to {uniform} along the road, no axles",
    "unfavourable": ", where it is unfavourable",
    "loaded": "the uniform load stands on the part of the road that is least favourable of those that the search met, "
    "at the worst position on {parts}",
    "part": "x = {low} to {high}", "no_part": "none of it",
    "an_axle": "a heaviest axle of {axle}",
    "a_load": "a uniform load of {uniform}",
    "head_holds": "The vehicle is carried at every position that was examined.",
    "head_fails": "The vehicle is not carried.",
    "head_open": "It was not established whether the vehicle is carried.",
    "fails": "{required} times the vehicle is not carried at x = {x}, travelling to the {way}: nothing is in "
    "equilibrium beyond {upper} times.",
    "fails_coulomb": "{required} times the vehicle is not carried at x = {x}, travelling to the {way}: applied in one "
    "step with Coulomb friction, the structure moves away.",
    "holds": "{required} times the vehicle is carried at each of {count} positions: a certified Coulomb state "
    "was found "
    "at each.",
    "open": "Whether {required} times the vehicle is carried was not shown at {count} of {all} positions.",
    "unasked": "No mechanism refutes {required} times the vehicle at any of {all} positions; what Coulomb friction "
    "carries was not asked for.",
    "worst": "Worst is x = {x}, travelling to the {way}: Coulomb friction carries {design} times it there, {axle}, "
    "and no equilibrium exists beyond {bound} times ({bound_axle}).",
    "worst_unknown": "Worst is x = {x}, travelling to the {way}: no equilibrium exists beyond {bound} times it "
    "there ({bound_axle}); the part that Coulomb friction carries was not found.",
    "less": "The least that Coulomb friction was shown to carry is {design} times it, {axle}, at x = {x}, travelling "
    "to the {way}.",
    "no_soil": "Without the pressure of the soil the bound is {multiplier} times, at x = {x}.",
    "no_soil_none": "Without the pressure of the soil the bridge does not stand even without a vehicle.",
    "rests": "the answer depends on the pressure of the soil: without it no equilibrium exists beyond {multiplier} "
    "times the vehicle, less than the {required} asked for",
    "rests_none": "the answer depends on the pressure of the soil: without it the bridge does not stand",
    "shares": "of the bound at the worst position {soil} % is due to the pressure of the soil and {spread} % to the "
    "spread of the load through the fill",
    "width": "a strip of {width} carries the vehicle: {by}",
    "grid": "positions are {step} apart, at the worst {fine}; between them nothing was checked",
    "several": "Coulomb friction has no unique answer: other states may exist, and settlements or earlier loads may "
    "lead to them",
    "plane": "the model is plane: skew, torsion, spandrel walls and the way in which load spreads across the "
    "bridge are "
    "in the width alone",
    "apart": "the second vehicle was placed at {count} distances from the first ({distances}); other distances, "
    "and one vehicle alone, were not",
    "spandrels": "spandrel walls count by their weight alone",
    "brackets": "positions at which what Coulomb friction carries at most was sought: {count}",
    "unchecked_coulomb": "Coulomb friction at the other positions (asked for at none)",
    "unchecked_some": "Coulomb friction at {rest} of {all} positions: there the bound alone was computed",
    "unchecked_crushing": "crushing: the joints have no compressive strength",
    "unchecked_long": "the abutments and the ground: fixed blocks carry whatever reaches them",
    "unchecked_both": "the vehicle in the other direction",
    "unchecked_state": "the working state: {status}",
    "proof": "bound at the worst position: forces in balance to {residual}, a mechanism without overlap to "
    "{violation}, "
    "their multipliers {gap} apart; {count} Coulomb states, each certified by the equations of the model",
    "meaning": "A load factor multiplies the vehicle where it stands. The associated bound lies above what Coulomb "
    "friction carries, and is never the design value.",
    "elsewhere": "at the worst position {load} of the vehicle reaches fixed blocks or stands beyond the bridge",
    "right": "right", "left": "left",
}  # fmt: skip
ITALIAN: Mapping[str, str] = {
    "asked": "{required} volte il veicolo '{vehicle}' ({loads}) in ogni posizione sul ponte, con tutti gli altri "
    "carichi applicati una volta",
    "loads_axles": "asse più pesante {axle}, {total} in tutto",
    "loads_both": "asse più pesante {axle}, {total} negli assi, e un carico uniforme fino a {uniform} lungo la strada",
    "loads_uniform": "un carico uniforme fino a {uniform} lungo la strada, senza assi",
    "unfavourable": ", dove è sfavorevole",
    "loaded": "il carico uniforme sta sulla parte di strada meno favorevole tra quelle incontrate nella ricerca, nella "
    "posizione peggiore su {parts}",
    "part": "x = {low} a {high}", "no_part": "nessuna parte",
    "an_axle": "un asse più pesante di {axle}",
    "a_load": "un carico uniforme di {uniform}",
    "head_holds": "Il veicolo è sostenuto in ogni posizione esaminata.",
    "head_fails": "Il veicolo non è sostenuto.",
    "head_open": "Non è stabilito se il veicolo sia sostenuto.",
    "fails": "{required} volte il veicolo non è sostenuto in x = {x}, con marcia verso {way}: oltre {upper} volte non "
    "esiste equilibrio.",
    "fails_coulomb": "{required} volte il veicolo non è sostenuto in x = {x}, con marcia verso {way}: applicato "
    "in un solo "
    "passo con attrito di Coulomb, la struttura si muove.",
    "holds": "{required} volte il veicolo è sostenuto in ciascuna di {count} posizioni: in ciascuna è stato trovato "
    "uno stato di Coulomb certificato.",
    "open": "Che {required} volte il veicolo sia sostenuto non è stato mostrato in {count} posizioni su {all}.",
    "unasked": "Nessun meccanismo esclude {required} volte il veicolo in alcuna di {all} posizioni; quanto porta "
    "l'attrito di Coulomb non è stato chiesto.",
    "worst": "La posizione peggiore è x = {x}, con marcia verso {way}: l'attrito di Coulomb vi porta {design} volte il "
    "veicolo, {axle}, e oltre {bound} volte ({bound_axle}) non esiste equilibrio.",
    "worst_unknown": "La posizione peggiore è x = {x}, con marcia verso {way}: oltre {bound} volte il veicolo "
    "({bound_axle}) non esiste equilibrio; la parte sostenuta con attrito di Coulomb non è stata trovata.",
    "less": "Il minimo che l'attrito di Coulomb porta, per quanto mostrato, è {design} volte il veicolo, {axle}, in "
    "x = {x}, con marcia verso {way}.",
    "no_soil": "Senza la spinta del terreno il limite è {multiplier} volte, in x = {x}.",
    "no_soil_none": "Senza la spinta del terreno il ponte non sta in piedi neppure senza veicolo.",
    "rests": "la risposta dipende dalla spinta del terreno: senza di essa non esiste equilibrio oltre {multiplier} "
    "volte il veicolo, meno delle {required} richieste",
    "rests_none": "la risposta dipende dalla spinta del terreno: senza di essa il ponte non sta in piedi",
    "shares": "del limite nella posizione peggiore il {soil} % è dovuto alla spinta del terreno e il {spread} % alla "
    "diffusione del carico nel riempimento",
    "width": "il veicolo è sostenuto da una striscia di {width}: {by}",
    "grid": "le posizioni distano {step}, nella zona peggiore {fine}; tra l'una e l'altra nulla è stato esaminato",
    "several": "l'attrito di Coulomb non dà una risposta unica: possono esistere altri stati, ai quali portano "
    "cedimenti "
    "o carichi precedenti",
    "plane": "il modello è piano: obliquità, torsione, timpani e diffusione trasversale del carico entrano solo nella "
    "larghezza",
    "apart": "il secondo veicolo è stato esaminato a {count} distanze dal primo ({distances}); altre distanze, e "
    "un veicolo solo, no",
    "spandrels": "i timpani contano solo con il loro peso",
    "brackets": "posizioni in cui è stato cercato quanto porta al massimo l'attrito di Coulomb: {count}",
    "unchecked_coulomb": "l'attrito di Coulomb nelle altre posizioni (non chiesto in alcuna)",
    "unchecked_some": "l'attrito di Coulomb in {rest} di {all} posizioni: lì è stato calcolato solo il limite",
    "unchecked_crushing": "lo schiacciamento: i giunti non hanno resistenza a compressione",
    "unchecked_long": "le spalle e il terreno: i blocchi fissi portano qualunque carico li raggiunga",
    "unchecked_both": "il veicolo nell'altra direzione",
    "unchecked_state": "lo stato di esercizio: {status}",
    "proof": "limite nella posizione peggiore: forze in equilibrio a meno di {residual}, un meccanismo senza "
    "compenetrazioni a meno di {violation}, moltiplicatori distanti {gap}; {count} stati di Coulomb, ciascuno "
    "certificato dalle equazioni del modello",
    "meaning": "Il fattore di carico moltiplica il veicolo dove si trova. Il limite associato sta sopra quanto porta "
    "l'attrito di Coulomb e non è mai il valore di progetto.",
    "elsewhere": "nella posizione peggiore {load} del veicolo raggiungono blocchi fissi o stanno oltre il ponte",
    "right": "destra", "left": "sinistra",
}  # fmt: skip
TEXTS: Mapping[str, Mapping[str, str]] = {"en": ENGLISH, "it": ITALIAN}
WIDTHS = (
    ("the whole width of the bodies", "tutta la larghezza del modello"), ("as given", "come assegnata"),
    ("that of the rule", "quella della regola"), (": the rule", ": la regola"),
    ("at the depth of", "alla profondità di"), ("m below the road", "m sotto la strada"), ("gives", "dà"),
)  # fmt: skip
"""Phrases of how widths are found, in English and Italian."""
ACTING = (
    ("constant; ", "costante; "), ("multiplied", "moltiplicato"), ("asked for", "chiesto"), ("reached", "raggiunto"),
    ("at factor 1", "con fattore 1"), ("not applied", "non applicato"), ("self-weight", "peso proprio"),
    ("point loads", "forze concentrate"), ("point load", "forza concentrata"), ("pressures", "pressioni"),
    ("in forces that balance", "in forze che si equilibrano"), (" along ", " lungo "),
)  # fmt: skip
"""Phrases of what acts, in English and Italian."""


class Words:
    """Sentences and numbers of one language.

    Parameters
    ----------
    language : {"en", "it"}
    units : Units
        In which quantities are reported.
    """

    def __init__(self, language: Language, units: Units) -> None:
        self.language, self.units = language, units

    def say(self, key: str, **values: object) -> str:
        """Return a sentence."""
        return TEXTS[self.language][key].format(**values)

    def local(self, text: str) -> str:
        """Return a number in words as the language writes it."""
        if self.language == "en":
            return text
        return re.sub(r"(?<=\d)\.(?=\d)", ",", re.sub(r"(?<=\d),(?=\d{3})", "\u2009", text))

    def width(self, text: str) -> str:
        """Return how a width was found."""
        return self._phrases(text, WIDTHS)

    def acting(self, text: str) -> str:
        """Return what acts of a load group."""
        group, mark, rest = text.partition(": ")
        return group + mark + self._phrases(rest, ACTING)

    def _phrases(self, text: str, phrases: tuple[tuple[str, str], ...]) -> str:
        """Return a sentence of the house with its phrases in the language."""
        if self.language == "en":
            return text
        for english, italian in phrases:
            text = text.replace(english, italian)
        return self.local(text)

    def n(self, value: float, digits: int = 4) -> str:
        """Return a number."""
        return self.local(number(value, digits))

    def unit(self, kind: str, value: float, digits: int = 4) -> str:
        """Return a quantity with its unit."""
        return self.local(self.units.text(kind, value, digits))
