!> Laws of macro-elements: a masonry section without tension that crushes, and the shear strength of a pier.
!>
!> Compression is positive. Sources: Penna, Lagomarsino and Galasco (2014) and Vanin, Penna and Beyer (2020) for the
!> section, Gambarotta and Lagomarsino (1997) for damage in shear, Turnsek and Cacovic (1971) for diagonal cracking.
module frame_laws
   use common_kinds, only : wp
   use common_lists, only : frame_shear_none, frame_shear_friction, frame_shear_diagonal, frame_shear_least, &
      frame_shear_damage, frame_shear_reversed
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: masonry_section, crushing, section_forces, crushed_further
   public :: shear_law, shear_resistance, back_stress, damage_at

   type :: masonry_section
      real(wp) :: length = 0.0_wp      !! depth of the section, along the wall [m]
      real(wp) :: thickness = 0.0_wp   !! [m]
      real(wp) :: young = 0.0_wp       !! [Pa]
      real(wp) :: strength = 0.0_wp    !! compressive strength of the stress block [Pa]
      real(wp) :: residual = 0.0_wp    !! share of the elastic stiffness that an open section keeps
   end type masonry_section

   !> What crushing has left at the edges at -L/2 and +L/2
   type :: crushing
      real(wp) :: ductility(2) = 1.0_wp   !! greatest edge strain over f/E
      real(wp) :: share(2) = 0.0_wp       !! greatest crushed share of the section
   end type crushing

   type :: shear_law
      integer(c_int) :: kind = frame_shear_none
      real(wp) :: length = 0.0_wp      !! of the pier along the wall [m]
      real(wp) :: thickness = 0.0_wp   !! [m]
      real(wp) :: cohesion = 0.0_wp    !! [Pa]
      real(wp) :: friction = 0.0_wp
      real(wp) :: tension = 0.0_wp     !! diagonal tensile strength f_t [Pa]
      real(wp) :: slenderness = 1.0_wp !! b = h/L within 1 and 1.5
      real(wp) :: compliance = 1.0_wp  !! damage: c_t h/(G L t) times G, that is c_t h / (L t) [1/m]
      real(wp) :: softening = 0.5_wp   !! damage: exponent of the resistance beyond the peak, below 2
      real(wp) :: peak_slip = 1.0_wp   !! damage: slip at the peak [m]
   end type shear_law

   !> Damage of a pier that has not slid: the law is linear below this share of its peak
   real(wp), parameter :: sound = 1.0e-3_wp

contains

   !> Normal force N and moment M of a section whose strain is e(1) + e(2) y, y within -L/2 and L/2.
   !>
   !> The elastic part without tension is integrated in closed form. From it comes the stress that crushing takes off: a
   !> linear deficit, E e_edge (1 - 1/m) at a crushed edge and zero at the depth z L.
   pure subroutine section_forces(section, e, past, force, tangent)
      type(masonry_section), intent(in) :: section
      real(wp), intent(in) :: e(2)               !! strain at the middle, curvature [1/m]
      type(crushing), intent(in) :: past
      real(wp), intent(out) :: force(2)          !! N [N], M [N m]
      real(wp), intent(out) :: tangent(2, 2)
      real(wp) :: low, high, root, stiff, power(3)
      integer :: edge
      associate (half => 0.5_wp * section%length)
         low = -half
         high = half
         if (e(2) /= 0.0_wp) then
            root = max(-half, min(half, -e(1) / e(2)))
            if (e(2) > 0.0_wp) then
               low = root
            else
               high = root
            end if
         else if (e(1) < 0.0_wp) then
            high = low
         end if
         stiff = section%young * section%thickness
         power = stiff * [high - low, (high**2 - low**2) / 2.0_wp, (high**3 - low**3) / 3.0_wp]
         tangent(:, 1) = power(1:2)
         tangent(:, 2) = power(2:3)
         force = e(1) * power(1:2) + e(2) * power(2:3)
         do edge = 1, 2
            call take_crushed(section, e, past%ductility(edge), past%share(edge), real(2 * edge - 3, wp), force, &
               tangent)
         end do
         stiff = section%residual * stiff * section%length
         force = force + stiff * [e(1), e(2) * section%length**2 / 12.0_wp]
         tangent(1, 1) = tangent(1, 1) + stiff
         tangent(2, 2) = tangent(2, 2) + stiff * section%length**2 / 12.0_wp
      end associate
   end subroutine section_forces

   !> Take off the deficit of one edge; each quantity goes with its derivatives by the two strains
   pure subroutine take_crushed(section, e, ductility, share, side, force, tangent)
      type(masonry_section), intent(in) :: section
      real(wp), intent(in) :: e(2)
      real(wp), intent(in) :: ductility
      real(wp), intent(in) :: share
      real(wp), intent(in) :: side               !! -1 or 1: the edge is at side L/2
      real(wp), intent(inout) :: force(2)
      real(wp), intent(inout) :: tangent(2, 2)
      real(wp) :: edge, yield, slope, b, db(2), r, dr(2), d_edge(2), lost(2), d_lost(2, 2)
      logical :: grows, presses
      associate (length => section%length, t => section%thickness)
         yield = section%strength / section%young
         d_edge = [1.0_wp, 0.5_wp * side * length]
         edge = dot_product(d_edge, e)
         slope = side * e(2)
         if (edge <= 0.0_wp) return
         presses = leads(slope, side)
         grows = edge > yield * ductility .and. presses
         if (grows) then
            b = section%young * (edge - yield)
            db = section%young * d_edge
         else
            if (ductility <= 1.0_wp) return
            b = section%young * edge * (1.0_wp - 1.0_wp / ductility)
            db = section%young * d_edge * (1.0_wp - 1.0_wp / ductility)
         end if
         ! r: one over the depth of the deficit; the deepest so far, but not beyond the neutral axis
         r = huge(1.0_wp)
         dr = 0.0_wp
         if (share > 0.0_wp) r = 1.0_wp / (share * length)
         if (edge > yield .and. presses) then
            if (slope / (edge - yield) < r) then
               r = slope / (edge - yield)
               dr = [0.0_wp, side] / (edge - yield) - slope / (edge - yield)**2 * d_edge
            end if
         end if
         if (slope / edge > r) then
            r = slope / edge
            dr = [0.0_wp, side] / edge - slope / edge**2 * d_edge
         end if
         if (r >= 0.5_wp * huge(1.0_wp)) return
         if (r * length >= 1.0_wp) then
            lost(1) = 0.5_wp * t * b / r
            d_lost(1, :) = 0.5_wp * t * (db / r - b / r**2 * dr)
            lost(2) = side * lost(1) * (0.5_wp * length - 1.0_wp / (3.0_wp * r))
            d_lost(2, :) = side * (d_lost(1, :) * (0.5_wp * length - 1.0_wp / (3.0_wp * r)) &
               + lost(1) / (3.0_wp * r**2) * dr)
         else   ! the deficit reaches the other edge
            lost(1) = t * length * b * (1.0_wp - 0.5_wp * r * length)
            d_lost(1, :) = t * length * (db * (1.0_wp - 0.5_wp * r * length) - 0.5_wp * length * b * dr)
            lost(2) = side * t * length**3 / 12.0_wp * b * r
            d_lost(2, :) = side * t * length**3 / 12.0_wp * (db * r + b * dr)
         end if
         force = force - lost
         tangent = tangent - d_lost
      end associate
   end subroutine take_crushed

   !> Whether crushing begins at this edge: at that of the greater strain; of uniform strains at one edge alone, which counts it once
   pure function leads(slope, side)
      real(wp), intent(in) :: slope              !! of the strain towards the edge
      real(wp), intent(in) :: side               !! -1 or 1
      logical :: leads
      leads = slope > 0.0_wp .or. (slope >= 0.0_wp .and. side > 0.0_wp)
   end function leads

   !> Crushing after a section has been at these strains
   pure function crushed_further(section, e, past) result(after)
      type(masonry_section), intent(in) :: section
      real(wp), intent(in) :: e(2)
      type(crushing), intent(in) :: past
      type(crushing) :: after
      real(wp), parameter :: whole = 1.0e6_wp   !! a share that stands for uniform crushing
      real(wp) :: edge, yield, slope
      integer :: k
      after = past
      yield = section%strength / section%young
      do k = 1, 2
         slope = real(2 * k - 3, wp) * e(2)
         edge = e(1) + 0.5_wp * section%length * slope
         if (edge <= yield .or. .not. leads(slope, real(2 * k - 3, wp))) cycle
         after%ductility(k) = max(past%ductility(k), edge / yield)
         after%share(k) = max(past%share(k), min(whole, (edge - yield) / max(slope * section%length, tiny(1.0_wp))))
      end do
   end function crushed_further

   !> Resistance R to sliding of a pier, its derivatives by the normal force and by the greatest end moment.
   !>
   !> friction: c t L' + mu N on the compressed length L' = 3 (L/2 - M/N), at most L. diagonal: L t f_t/b
   !> sqrt(1 + N/(L t f_t)). least: the lesser of both. reversed: the same, with cohesion on the part 2 L' - L alone,
   !> which opens in neither sense of a reversed load. damage: mu N, beside `back_stress`. Nothing without pressure.
   pure subroutine shear_resistance(law, normal, moment, resistance, by)
      type(shear_law), intent(in) :: law
      real(wp), intent(in) :: normal          !! N [N]
      real(wp), intent(in) :: moment          !! greatest moment of its ends, not negative [N m]
      real(wp), intent(out) :: resistance     !! [N]
      real(wp), intent(out) :: by(2)          !! derivatives by N and by the moment
      real(wp) :: pressed, area, root, split, bonded, slope
      resistance = 0.0_wp
      by = 0.0_wp
      if (normal <= 0.0_wp) return
      area = law%length * law%thickness
      select case (law%kind)
      case (frame_shear_friction, frame_shear_least, frame_shear_reversed)
         resistance = law%friction * normal + law%cohesion * area
         by(1) = law%friction
         pressed = 3.0_wp * (0.5_wp * law%length - moment / normal)
         if (pressed < law%length) then
            slope = merge(2.0_wp, 1.0_wp, law%kind == frame_shear_reversed)
            bonded = law%length - slope * (law%length - pressed)
            resistance = law%friction * normal + law%cohesion * law%thickness * max(0.0_wp, bonded)
            slope = 3.0_wp * slope * law%cohesion * law%thickness / normal
            if (bonded > 0.0_wp) by = [law%friction + slope * moment / normal, -slope]
         end if
      case (frame_shear_damage)
         resistance = law%friction * normal
         by(1) = law%friction
      case default
         resistance = huge(1.0_wp)
      end select
      if (all(law%kind /= [frame_shear_diagonal, frame_shear_least, frame_shear_reversed])) return
      root = sqrt(1.0_wp + normal / (area * law%tension))
      split = area * law%tension / law%slenderness * root
      if (split >= resistance) return
      resistance = split
      by = [0.5_wp / (law%slenderness * root), 0.0_wp]
   end subroutine shear_resistance

   !> Damage of the damage law after a slip: (s/s_p)^(2/3) to the peak, (s/s_p)^(2/(2 - beta)) beyond
   pure function damage_at(law, slip) result(damage)
      type(shear_law), intent(in) :: law
      real(wp), intent(in) :: slip            !! [m]
      real(wp) :: damage
      real(wp) :: ratio
      ratio = abs(slip) / law%peak_slip
      damage = max(sound, ratio**merge(2.0_wp / 3.0_wp, 2.0_wp / (2.0_wp - law%softening), ratio <= 1.0_wp))
   end function damage_at

   !> Stress resultant about which the damage law slides, B = s/(compliance damage), and its derivative by the slip
   pure subroutine back_stress(law, slip, past, value, by)
      type(shear_law), intent(in) :: law
      real(wp), intent(in) :: slip            !! [m]
      real(wp), intent(in) :: past            !! damage so far
      real(wp), intent(out) :: value          !! [N]
      real(wp), intent(out) :: by             !! [N/m]
      real(wp) :: damage, power
      value = 0.0_wp
      by = 0.0_wp
      if (law%kind /= frame_shear_damage) return
      damage = damage_at(law, slip)
      power = 0.0_wp
      if (damage > max(past, sound)) power = merge(2.0_wp / 3.0_wp, 2.0_wp / (2.0_wp - law%softening), damage <= 1.0_wp)
      damage = max(damage, past)
      value = slip / (law%compliance * damage)
      by = (1.0_wp - power) / (law%compliance * damage)
   end subroutine back_stress

end module frame_laws
