!> Points of joints of no thickness: the law as it stands across and along the joint, and the loads that a point admits.
!>
!> Across the joint acts sigma (tension positive), along it tau, by the jumps dn and ds of the displacements. Every
!> limit is linear in the load multiplier:
!>   tension      sigma <= f                  teeth of a softening law whose strain is the opening (band 1)
!>   compression  -sigma <= fc                teeth of one whose strain is the shortening
!>   sliding      |tau| <= c1 - mu sigma      before the first slip, c1 the first tooth of the cohesion
!>                |tau_c| <= c_i              after it: teeth of a law whose strain is the slip, energy of mode II;
!>                                            c_i - mu sigma where the joint is pulled
!>                |tau_f| <= -mu sigma        its friction where it is pressed, beside the cohesion: tau = tau_c + tau_f
!> Where friction sticks it is elastic, with what stiffness the cohesion has lost. Where it slides, tau_f = -/+ mu sigma
!> is a force that follows the displacements, see sla_friction. Slip that turns back sticks.
!>
!> Cohesion and tension are one bond: the same part of both is left (Lourenco and Rots 1997). The split of a bond and a
!> slider is that of Alfano and Sacco (2006), but that here friction helps from the start, as in Coulomb's law. The bond
!> is a spring from zero slip, so its teeth are stretched by the slip s = mu |sigma| / ks that friction alone allowed
!> before the first: c_i at the slip c_i / k_i + s. Were the spring to begin at s, the first slip would create energy.
!>
!> Cracked joints close again with their initial normal stiffness. What opens without strength, and what closes, does so
!> at zero stress; a joint that closes slides on as it moved.
!>
!> In the plane the jumps are those of pairs of nodes with two freedoms. Of shells in space they are those of a layer,
!> from the displacements and the rotations of a pair; an element then stands for one layer of a stretch.
module sla_joint_points
   use common_kinds, only : wp
   use common_lists, only : code_tension => sla_event_tension, code_compression => sla_event_compression, &
      code_close => sla_event_close, code_open => sla_event_open, code_wear => sla_event_wear, &
      code_slide => sla_event_slide, code_stick => sla_event_stick
   use common_status, only : status_ok, status_out_of_memory
   use sla_group, only : friction_group, scan_result, unbounded, linear_bound, offer_hi, most_entries
   use sla_tables, only : tooth_tables
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: joint_points, joint_law, joint_law_new, line, sticks, slides_up, slides_down, soft
   public :: jump, nodal, across, along, shear, bond, bond_of, modulus, slips, is_closed, is_sliding, scan_point

   !> How the friction of a closed point is
   integer(c_int), parameter :: sticks = 0, slides_up = 1, slides_down = 2
   !> Slip back that counts as sticking, over the ripple and the elastic slip of the friction
   real(wp), parameter :: turned = 4.0_wp
   !> Stiffness that a point which slides keeps in the factor, over that of one that sticks; its force takes that back.
   !> With less of it the factor loses digits, with more the energies, see `excess`
   real(wp), parameter :: soft = 1.0e-4_wp
   !> What the law along a joint holds back is changed beside its stiffness, which then changes by so much: of an open
   !> joint over what is left of it, of a closed one over the whole
   real(wp), parameter :: hundredth = 0.01_wp, least_change = 1.0e-11_wp

   !> What the joints of a group are made of, each (elements)
   type :: joint_law
      real(wp), allocatable :: kn(:)            !! normal stiffness [Pa/m]
      real(wp), allocatable :: ks(:)            !! shear stiffness [Pa/m]
      real(wp), allocatable :: friction(:)      !! coefficient; negative: no sliding
      real(wp), allocatable :: small(:)         !! stress that counts as small [Pa]
      integer(c_int), allocatable :: table(:)   !! tension teeth; 0 none: no limit, or none left where dry
      integer(c_int), allocatable :: crush_table(:)
      integer(c_int), allocatable :: slip_table(:)   !! teeth of the cohesion, 0 none
      integer(c_int), allocatable :: dry(:)     !! 1: no tensile strength
      real(wp) :: ripple = 0.02_wp              !! see `turned`
   end type joint_law

   type, abstract, extends(friction_group) :: joint_points
      type(joint_law) :: law
      type(tooth_tables) :: teeth
      real(wp), allocatable :: normal(:, :)      !! (2, elements) from the lower to the upper side
      !> Of joints between shells: vectors whose products with the displacements are the jumps across and along the
      !> joint, and that out of the plane of the shell, which no joint follows
      real(wp), allocatable :: row(:, :, :)      !! (freedoms, 3, points)
      real(wp), allocatable :: area(:)           !! (points) [m^2]
      ! The damage: everything else follows from it.
      integer(c_int), allocatable :: tooth(:)    !! of tension, 1 virgin
      integer(c_int), allocatable :: crush(:)    !! of compression, 1 virgin
      integer(c_int), allocatable :: slip(:)     !! of the cohesion, 1 virgin
      integer(c_int), allocatable :: shut(:)     !! 1 closed; of cracked points
      integer(c_int), allocatable :: changes(:)  !! openings and closings
      integer(c_int), allocatable :: mode(:)     !! sticks, slides_up, slides_down
      integer(c_int), allocatable :: even(:)     !! 0 or 1, changes with the held force
      real(wp), allocatable :: start(:)          !! slip by which the teeth of the cohesion are stretched [m]
      real(wp), allocatable :: mark(:)           !! slip but for what is elastic in its friction, so far [m]
      real(wp), allocatable :: held(:, :)        !! (2, points) see `slider`, constant and per multiplier [Pa]
      real(wp), allocatable :: stuck(:)          !! multiplier at which a sliding point has stuck last
   contains
      procedure :: scan
      procedure :: margin
   end type joint_points

   !> The law along the joint, tau = k ds - k0 + h; its elastic energy is k ds^2 / 2 - k0 ds + e0
   type :: line
      real(wp) :: k = 0.0_wp      !! [Pa/m]
      real(wp) :: k0 = 0.0_wp     !! [Pa]
      real(wp) :: e0 = 0.0_wp     !! [J/m^2]
      real(wp) :: h(2) = 0.0_wp   !! constant and per unit multiplier [Pa]
   end type line

contains

   !> Room for the law of some elements
   subroutine joint_law_new(elements, law, status)
      integer, intent(in) :: elements
      type(joint_law), intent(out) :: law
      integer(c_int), intent(out) :: status
      integer :: info
      allocate (law%kn(elements), law%ks(elements), law%friction(elements), law%small(elements), law%table(elements), &
         law%crush_table(elements), law%slip_table(elements), law%dry(elements), stat=info)
      status = merge(status_ok, status_out_of_memory, info == 0)
   end subroutine joint_law_new

   !> The freedoms of a point: of its node below, then of the one above
   pure function freedoms_of(p) result(at)
      integer, intent(in) :: p
      integer :: at(4)
      at = merge([1, 2, 7, 8], [3, 4, 5, 6], mod(p, 2) == 1)
   end function freedoms_of

   !> Jumps of the displacements across and along the joint [m]
   pure function jump(group, e, p, local) result(d)
      class(joint_points), intent(in) :: group
      integer, intent(in) :: e, p
      real(wp), intent(in) :: local(:)
      real(wp) :: d(2), u(2)
      integer :: at(4), i
      if (allocated(group%row)) then
         d = 0.0_wp
         do i = 1, group%freedoms
            d = d + group%row(i, 1:2, p) * local(i)
         end do
         return
      end if
      at = freedoms_of(p)
      u = local(at(3:4)) - local(at(1:2))
      associate (n => group%normal(:, e))
         d = [n(1) * u(1) + n(2) * u(2), n(2) * u(1) - n(1) * u(2)]
      end associate
   end function jump

   !> Nodal vector of the element whose product with the displacements is v(1) dn + v(2) ds
   pure function nodal(group, e, p, v) result(local)
      class(joint_points), intent(in) :: group
      integer, intent(in) :: e, p
      real(wp), intent(in) :: v(2)
      real(wp) :: local(most_entries), u(2)
      integer :: at(4), n
      local = 0.0_wp
      if (allocated(group%row)) then
         n = group%freedoms
         local(1:n) = v(1) * group%row(1:n, 1, p) + v(2) * group%row(1:n, 2, p)
         return
      end if
      at = freedoms_of(p)
      associate (n => group%normal(:, e))
         u = [n(1) * v(1) + n(2) * v(2), n(2) * v(1) - n(1) * v(2)]
      end associate
      local(at(1:2)) = -u
      local(at(3:4)) = u
   end function nodal

   !> True where the joint presses or has never cracked
   pure function is_closed(group, p) result(closed)
      class(joint_points), intent(in) :: group
      integer, intent(in) :: p
      logical :: closed
      closed = group%tooth(p) == 1 .or. group%shut(p) /= 0
   end function is_closed

   !> Stiffness of the bond along the joint [Pa/m]
   pure function bond(group, e, p) result(k)
      class(joint_points), intent(in) :: group
      integer, intent(in) :: e, p
      real(wp) :: k
      k = 0.0_wp
      if (group%law%slip_table(e) /= 0) k = bond_of(group, e, p, group%slip(p))
   end function bond

   !> Stiffness of the bond at a tooth [Pa/m]
   pure function bond_of(group, e, p, tooth) result(k)
      class(joint_points), intent(in) :: group
      integer, intent(in) :: e, p
      integer(c_int), intent(in) :: tooth
      real(wp) :: k, f
      k = modulus(group, e, tooth)
      f = group%teeth%strength_of(group%law%slip_table(e), tooth, 1.0_wp)
      if (group%start(p) > 0.0_wp .and. f < unbounded) k = k * f / (f + k * group%start(p))
   end function bond_of

   !> Stiffness of a tooth of the cohesion, by its own slip [Pa/m]
   pure function modulus(group, e, tooth) result(k)
      class(joint_points), intent(in) :: group
      integer, intent(in) :: e
      integer(c_int), intent(in) :: tooth
      real(wp) :: k
      k = group%teeth%modulus_of(group%law%slip_table(e), tooth, group%law%ks(e), 0.0_wp)
   end function modulus

   !> Secant stiffness across the joint [Pa/m]
   pure function across(group, e, p) result(k)
      class(joint_points), intent(in) :: group
      integer, intent(in) :: e, p
      real(wp) :: k, open
      associate (law => group%law, floor => group%options%floor)
         k = group%teeth%modulus_of(law%crush_table(e), group%crush(p), law%kn(e), floor)
         if (is_closed(group, p)) return
         open = floor * law%kn(e)
         if (law%table(e) /= 0) open = group%teeth%modulus_of(law%table(e), group%tooth(p), law%kn(e), floor)
         k = min(k, open)
      end associate
   end function across

   !> Stiffness along a closed joint that sticks [Pa/m]
   pure function shear(group, e, p) result(k)
      class(joint_points), intent(in) :: group
      integer, intent(in) :: e, p
      real(wp) :: k
      k = group%law%ks(e) * (1.0_wp + least_change * real(group%even(p), wp))
   end function shear

   !> The law along the joint as it stands
   pure function along(group, e, p) result(law)
      class(joint_points), intent(in) :: group
      integer, intent(in) :: e, p
      type(line) :: law
      real(wp) :: k
      if (group%law%friction(e) < 0.0_wp) then
         law = line(k=group%law%ks(e))
         return
      end if
      k = bond(group, e, p)
      law = line(k=k)
      if (.not. is_closed(group, p)) then
         law%k = k + group%options%floor * group%law%ks(e) * (1.0_wp + hundredth * real(group%even(p), wp))
         return
      end if
      law%k = shear(group, e, p)
      if (group%mode(p) == sticks) then
         law%k0 = law%k0 + (law%k - k) * group%mark(p)
         law%e0 = law%e0 + 0.5_wp * (law%k - k) * group%mark(p)**2
      else   ! a spring, and h, which takes it away and puts friction there
         law%k = k + soft * law%k
         law%h = group%held(:, p)
      end if
   end function along

   !> Can a closed point slide? Mortar of which no cohesion is given holds until it is torn
   pure function slips(group, e, p) result(yes)
      class(joint_points), intent(in) :: group
      integer, intent(in) :: e, p
      logical :: yes
      yes = group%law%friction(e) >= 0.0_wp .and. group%slip(p) > 1
      if (yes) yes = group%law%slip_table(e) /= 0 .or. group%tooth(p) > 1
   end function slips

   !> Does the friction of a point slide?
   pure function is_sliding(group, p) result(yes)
      class(joint_points), intent(in) :: group
      integer, intent(in) :: p
      logical :: yes
      yes = group%mode(p) /= sticks .and. is_closed(group, p) .and. group%area(p) > 0.0_wp
   end function is_sliding

   pure subroutine scan(group, first, last, ua, ub, lambda, noise, found)
      class(joint_points), intent(in) :: group
      integer, intent(in) :: first
      integer, intent(in) :: last
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: noise
      type(scan_result), intent(inout) :: found
      real(wp) :: la(most_entries), lb(most_entries)
      integer :: e, p
      do e = first, last
         call group%gather(e, ua, la)
         call group%gather(e, ub, lb)
         do p = 2 * e - 1, 2 * e
            if (group%area(p) > 0.0_wp) call scan_point(group, e, p, jump(group, e, p, la), jump(group, e, p, lb), &
               lambda, noise, found)
         end do
      end do
   end subroutine scan

   !> Limits of one point from its jumps
   pure subroutine scan_point(group, e, p, da, db, lambda, noise, found)
      class(joint_points), intent(in) :: group
      integer, intent(in) :: e, p
      real(wp), intent(in) :: da(2)       !! constant loads [m]
      real(wp), intent(in) :: db(2)       !! per unit multiplier [m]
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: noise
      type(scan_result), intent(inout) :: found
      real(wp) :: f, mu, part, sa, sb, scale, k, spring, ta, tb
      integer :: side

      associate (law => group%law, kn => group%law%kn(e), ks => group%law%ks(e))
         k = across(group, e, p)
         sa = k * da(1)
         sb = k * db(1)
         f = group%teeth%strength_of(law%crush_table(e), group%crush(p), 1.0_wp)
         if (f < unbounded) call linear_bound(-sa, -sb, f, f, lambda, noise, p, code_compression, found)
         scale = law%small(e)
         if (is_closed(group, p) .and. group%tooth(p) > 1) then
            call linear_bound(sa, sb, 0.0_wp, scale, lambda, noise, p, code_open, found)
         else
            f = group%teeth%strength_of(law%table(e), group%tooth(p), 1.0_wp)
            if (f < unbounded) call linear_bound(sa, sb, f, f, lambda, noise, p, code_tension, found)
            ! Measured by the jump: the stress that an open joint has left drowns in rounding.
            if (group%tooth(p) > 1 .and. group%changes(p) < group%options%most_changes) then
               call linear_bound(-kn * da(1), -kn * db(1), 0.0_wp, scale, lambda, noise, p, code_close, found)
            end if
         end if
         mu = law%friction(e)
         if (mu < 0.0_wp) return
         k = bond(group, e, p)
         f = group%teeth%strength_of(law%slip_table(e), group%slip(p), 1.0_wp)
         if (f < unbounded .or. group%slip(p) == 1) then
            part = merge(0.0_wp, mu, is_closed(group, p) .and. group%slip(p) > 1)
            do side = 1, -1, -2
               call linear_bound(side * k * da(2) + part * sa, side * k * db(2) + part * sb, f, f, lambda, noise, p, &
                  code_wear, found)
            end do
         end if
         if (.not. (is_closed(group, p) .and. slips(group, e, p))) return
         spring = shear(group, e, p) - k
         ta = spring * (da(2) - group%mark(p))
         tb = spring * db(2)
         if (group%mode(p) == sticks) then
            do side = 1, -1, -2
               call offer_reach(side * tb + mu * sb, -side * ta - mu * sa, scale, lambda, noise, p, code_slide, found)
            end do
            return
         end if
         ! It turns back where its slip without what is elastic does, which its force, as the slip, is linear in the
         ! multiplier
         side = merge(1, -1, group%mode(p) == slides_up)
         k = soft * shear(group, e, p)
         ta = ta - group%held(1, p) - k * da(2)
         tb = tb - group%held(2, p) - k * db(2)
         k = side * (group%held(1, p) + lambda * group%held(2, p) + k * (da(2) + lambda * db(2)))
         if (-side * tb > noise) call offer_reach(-side * tb, turned * law%ripple * max(k, scale) + side * ta, 0.0_wp, &
            lambda, noise, p, code_stick, found)
      end associate
   end subroutine scan_point

   !> See point_group: the same limits as scan_point, of points that have not slid
   pure subroutine margin(group, first, last, ua, ub, lambda, least)
      class(joint_points), intent(in) :: group
      integer, intent(in) :: first
      integer, intent(in) :: last
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: lambda(:)
      real(wp), intent(inout) :: least(:)
      real(wp) :: la(most_entries), lb(most_entries), da(2), db(2), k, f, w, mu, part, bonded, spring
      integer :: e, p
      do e = first, last
         call group%gather(e, ua, la)
         call group%gather(e, ub, lb)
         do p = 2 * e - 1, 2 * e
            if (.not. group%area(p) > 0.0_wp) cycle
            if (group%mode(p) /= sticks) then
               least = -1.0_wp
               return
            end if
            w = group%area(p)
            da = jump(group, e, p, la)
            db = jump(group, e, p, lb)
            k = across(group, e, p)
            f = group%teeth%strength_of(group%law%crush_table(e), group%crush(p), 1.0_wp)
            if (f < unbounded) call lower_margin([-k, 0.0_wp], f, k, w, da, db, lambda, least)
            if (is_closed(group, p) .and. group%tooth(p) > 1) then
               call lower_margin([k, 0.0_wp], 0.0_wp, k, w, da, db, lambda, least)
            else
               f = group%teeth%strength_of(group%law%table(e), group%tooth(p), 1.0_wp)
               if (f < unbounded) call lower_margin([k, 0.0_wp], f, k, w, da, db, lambda, least)
               if (group%tooth(p) > 1 .and. group%changes(p) < group%options%most_changes) call lower_margin([-k, &
                  0.0_wp], &
                  0.0_wp, k, w, da, db, lambda, least)
            end if
            mu = group%law%friction(e)
            if (mu < 0.0_wp) cycle
            bonded = bond(group, e, p)
            f = group%teeth%strength_of(group%law%slip_table(e), group%slip(p), 1.0_wp)
            if (f < unbounded .or. group%slip(p) == 1) then
               part = merge(0.0_wp, mu, is_closed(group, p) .and. group%slip(p) > 1)
               call lower_margin_both([part * k, bonded], 0.0_wp, f, part**2 * k + bonded, w, da, db, lambda, least)
            end if
            if (.not. (is_closed(group, p) .and. slips(group, e, p))) cycle
            spring = shear(group, e, p) - bonded
            call lower_margin_both([mu * k, spring], group%mark(p), 0.0_wp, mu**2 * k + spring, w, da, db, lambda, &
               least)
         end do
      end do
   end subroutine margin

   !> What a limit c.d <= f of the jumps d = da + lambda db leaves. A change with the energy U adds at most
   !> sqrt(2 U stiff / w), where the joint is no softer than k across and s along and stiff = c_n^2 / k + c_s^2 / s
   pure subroutine lower_margin(c, f, stiff, area, da, db, lambda, least)
      real(wp), intent(in) :: c(2)            !! [Pa/m]
      real(wp), intent(in) :: f               !! [Pa]
      real(wp), intent(in) :: stiff           !! [Pa/m]
      real(wp), intent(in) :: area            !! w [m^2]
      real(wp), intent(in) :: da(2)           !! [m]
      real(wp), intent(in) :: db(2)           !! [m]
      real(wp), intent(in) :: lambda(:)
      real(wp), intent(inout) :: least(:)     !! see point_group
      if (.not. stiff > 0.0_wp) return
      least = min(least, sqrt(area / stiff) * (f - dot_product(c, da) - lambda * dot_product(c, db)))
   end subroutine lower_margin

   !> As lower, of slip from `start` in both senses
   pure subroutine lower_margin_both(c, start, f, stiff, area, da, db, lambda, least)
      real(wp), intent(in) :: c(2)            !! [Pa/m]
      real(wp), intent(in) :: start           !! [m]
      real(wp), intent(in) :: f               !! [Pa]
      real(wp), intent(in) :: stiff           !! [Pa/m]
      real(wp), intent(in) :: area            !! w [m^2]
      real(wp), intent(in) :: da(2)           !! [m]
      real(wp), intent(in) :: db(2)           !! [m]
      real(wp), intent(in) :: lambda(:)
      real(wp), intent(inout) :: least(:)     !! see point_group
      call lower_margin(c, f + c(2) * start, stiff, area, da, db, lambda, least)
      call lower_margin([c(1), -c(2)], f - c(2) * start, stiff, area, da, db, lambda, least)
   end subroutine lower_margin_both

   !> What grows by `rate` per unit multiplier reaches `room` as the load grows, or at once where it is beyond: it never
   !> asks for less load than there is. A load that falls for the next tooth is the method's, no reversal.
   pure subroutine offer_reach(rate, room, least, lambda, noise, point, code, found)
      real(wp), intent(in) :: rate     !! [Pa]
      real(wp), intent(in) :: room     !! [Pa]
      real(wp), intent(in) :: least    !! [Pa]
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: noise
      integer, intent(in) :: point, code
      type(scan_result), intent(inout) :: found
      if (rate > noise) then
         call offer_hi(found, max(room / rate, lambda), point, code)
      else if (room < rate * lambda - least) then
         call offer_hi(found, lambda, point, code)
      end if
   end subroutine offer_reach

end module sla_joint_points
