"""Terms of the field in five languages: `extrados explain catena` finds tie rods, and the page glossary.md lists them all."""

import unicodedata
from dataclasses import dataclass

from extrados.decks.synonyms import plainly

LANGUAGES = ("English", "Italian", "French", "German", "Spanish")


@dataclass(frozen=True)
class Term:
    """One term: its words in each of LANGUAGES, several where they are common; the first English one is what `explain` knows."""

    words: tuple[tuple[str, ...], ...]

    @property
    def english(self) -> str:
        """The word under which decks and results have it."""
        return self.words[0][0]


def _term(line: str) -> Term:
    return Term(tuple(tuple(word.strip() for word in words.split(",")) for words in line.split("|")))


TERMS: tuple[Term, ...] = tuple(
    map(
        _term,
        (
            # shapes and parts
            "arch | arco | arc | Bogen | arco",
            "voussoirs | concio | claveau, voussoir | Keilstein, Wölbstein | dovela",
            "keystone | concio di chiave, chiave di volta | clef de voûte | Schlussstein | clave",
            "springing | imposta | naissance, retombée | Kämpfer | arranque",
            "intrados | intradosso | intrados | Bogenleibung | intradós",
            "extrados | estradosso | extrados | Bogenrücken | extradós, trasdós",
            "span | luce | portée | Spannweite | luz",
            "rise | freccia | flèche | Stich, Pfeilhöhe | flecha",
            "thickness | spessore | épaisseur | Dicke | espesor",
            "backing | rinfianco | garnissage, remplissage des reins | Hintermauerung | relleno de riñones",
            "backfill | riempimento | remblai | Hinterfüllung | relleno",
            "spandrel fill | timpano | tympan | Bogenzwickel | tímpano, enjuta",
            "pier | pila, pilastro | pile, pilier | Pfeiler | pila, pilar",
            "column | colonna | colonne | Säule | columna",
            "abutment | spalla | culée | Widerlager | estribo",
            "buttress | contrafforte | contrefort | Strebepfeiler | contrafuerte",
            "flying buttress | arco rampante | arc-boutant | Strebebogen | arbotante",
            "vault | volta | voûte | Gewölbe | bóveda",
            "cross vault | volta a crociera | voûte d'arêtes, croisée d'ogives | Kreuzgewölbe | bóveda de arista",
            "dome | cupola | coupole, dôme | Kuppel | cúpula",
            "nave | navata | nef | Mittelschiff | nave",
            "aisle | navata laterale | bas-côté, collatéral | Seitenschiff | nave lateral",
            "church | chiesa | église | Kirche | iglesia",
            "bridge | ponte | pont | Brücke | puente",
            "wall | muro, parete | mur | Wand, Mauer | muro",
            "facade | facciata | façade | Fassade | fachada",
            "gable | frontone | pignon | Giebel | hastial, piñón",
            "parapet | parapetto | garde-corps, parapet | Brüstung | parapeto, antepecho",
            "chimney | ciminiera | cheminée | Schornstein | chimenea",
            "pinnacle | pinnacolo | pinacle | Fiale | pináculo",
            "lintels | architrave | linteau | Sturz | dintel",
            "opening | apertura | ouverture | Öffnung | hueco",
            "storey | piano | étage | Geschoss | planta",
            "floor | solaio | plancher | Geschossdecke | forjado",
            "house | edificio, casa | bâtiment, maison | Gebäude, Haus | edificio, casa",
            "statue | statua | statue | Statue, Standbild | estatua",
            "pedestal | piedistallo, basamento | piédestal, socle | Sockel, Postament | pedestal",
            "survey drawing | rilievo | relevé | Bauaufnahme, Aufmass | levantamiento",
            # material, joints, supports
            "block | blocco | bloc | Block | bloque",
            "brick | mattone | brique | Ziegel, Backstein | ladrillo",
            "mortar | malta | mortier | Mörtel | mortero",
            "joints | giunto | joint | Fuge | junta",
            "bed joint | giunto di letto | joint d'assise, joint horizontal | Lagerfuge | tendel",
            "head joint | giunto verticale | joint vertical | Stossfuge | llaga",
            "density | densità, massa volumica | masse volumique | Dichte, Rohdichte | densidad",
            "unit weight | peso specifico | poids volumique | Wichte | peso específico",
            "elastic modulus | modulo elastico | module d'élasticité | Elastizitätsmodul | módulo de elasticidad",
            "compressive strength | resistenza a compressione | résistance à la compression | Druckfestigkeit | resistencia a compresión",
            "tensile strength | resistenza a trazione | résistance à la traction | Zugfestigkeit | resistencia a tracción",
            "cohesion | coesione | cohésion | Kohäsion | cohesión",
            "coefficient of friction | attrito, coefficiente d'attrito | frottement, coefficient de frottement | Reibung, Reibungsbeiwert | rozamiento",
            "sliding | scorrimento, slittamento | glissement | Gleiten | deslizamiento",
            "tie rod | catena, tirante | tirant | Zuganker, Zugstange | tirante",
            "damper | smorzatore | amortisseur | Dämpfer | amortiguador",
            "settlement | cedimento | tassement | Setzung | asiento",
            "strengthening | rinforzo, consolidamento | renforcement, confortement | Verstärkung, Ertüchtigung | refuerzo",
            # loads, motions, results
            "earthquake | terremoto, sisma | séisme, tremblement de terre | Erdbeben | terremoto, sismo",
            "peak ground acceleration | accelerazione di picco al suolo | accélération maximale du sol | Spitzenbodenbeschleunigung | aceleración máxima del suelo",
            "response spectrum | spettro di risposta | spectre de réponse | Antwortspektrum | espectro de respuesta",
            "return period | periodo di ritorno | période de retour | Wiederkehrperiode | periodo de retorno",
            "behaviour factor | fattore di comportamento, fattore di struttura | coefficient de comportement | Verhaltensbeiwert | coeficiente de comportamiento",
            "dead load | carico permanente | charge permanente | Eigenlast | carga permanente",
            "live load | carico mobile, sovraccarico | charge d'exploitation, convoi | Verkehrslast, Nutzlast | sobrecarga",
            "thrust | spinta | poussée | Bogenschub | empuje",
            "thrust line | linea delle pressioni, curva delle pressioni | ligne de pression, ligne de poussée | Stützlinie, Drucklinie | línea de empujes, línea de presiones",
            "hinge | cerniera | rotule, charnière | Gelenk | rótula, articulación",
            "mechanism | cinematismo, meccanismo | mécanisme | Mechanismus | mecanismo",
            "collapse multiplier | moltiplicatore di collasso | multiplicateur de ruine | Traglastfaktor | multiplicador de colapso",
            "safety factor | coefficiente di sicurezza | coefficient de sécurité | Sicherheitsbeiwert | coeficiente de seguridad",
            "overturning | ribaltamento | renversement | Kippen | vuelco",
            "cracking | fessurazione, fessura | fissuration, fissure | Rissbildung, Riss | fisuración, fisura, grieta",
            "push over | analisi statica non lineare | poussée progressive | nichtlineare statische Berechnung | empuje progresivo",
            "base shear | taglio alla base | effort tranchant à la base | Gesamterdbebenkraft | cortante basal",
            "fragility curve | curva di fragilità | courbe de fragilité | Fragilitätskurve | curva de fragilidad",
        ),
    )
)


def bare(word: str) -> str:
    """A word as it is compared: as `plainly`, and without accents."""
    taken = unicodedata.normalize("NFKD", plainly(word.replace("ß", "ss")))
    return "".join(letter for letter in taken if not unicodedata.combining(letter))


def translated(word: str) -> list[tuple[str, Term]]:
    """The terms that a word of another language than English stands for, each with the language."""
    asked = bare(word)
    return [
        (language, term)
        for term in TERMS
        for language, words in zip(LANGUAGES[1:], term.words[1:], strict=True)
        if asked in map(bare, words)
    ]


def table() -> str:
    """All terms as a table of Markdown, in the order of the English words."""
    rows = [[", ".join(words) for words in term.words] for term in sorted(TERMS, key=lambda term: term.english)]
    heads = [LANGUAGES, ["---"] * len(LANGUAGES), *rows]
    return "\n".join("| " + " | ".join(row) + " |" for row in heads) + "\n"
