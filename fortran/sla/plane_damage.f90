!> What a tooth does to a point of orthogonal cracks with saw-tooth softening, and to the stiffness (thesis 4.3.2).
!>
!> One tooth changes one diagonal term of a point's compliance and its shear modulus, see sla_plane_points: the
!> stiffness changes by rank two, by three where the crack turns.
!>
!> Rotating cracks (Cope and others 1980; Rots 1988) turn with the principal strain, at each tooth of the point. Fixed
!> ones keep the direction of their first tooth, which is seldom that of the crack that opens later: the stress along
!> them then carries load across it ("stress locking", Rots 1988; Jirasek and Zimmermann 1998). What is left of it in
!> elements that the crack crosses askew goes where the stiffness along an opening crack is bounded by a multiple of
!> that across it, which in the end makes the damage a scalar one, as Jirasek and Zimmermann propose.
module sla_plane_damage
   use common_jacobi, only : principal
   use common_kinds, only : wp
   use common_lists, only : isotropic => sla_cracking_isotropic, rotating => sla_cracking_rotating
   use common_lists, only : code_tension => sla_event_tension, code_compression => sla_event_compression, &
      code_close => sla_event_close
   use sla_group, only : scan_result, event_vectors, most_entries, admitted
   use sla_plane_history, only : plane_history
   use sla_plane_points, only : axis_free, in_crack_axes, in_element_axes, stress_at, scan_point, &
      is_bedded, most_per, open_bedded, share_of, direction_modulus, set_pair, set_band, width_across
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: plane_damage, damage_point

   !> A crack that lies nearer to the principal strain than this stays where it is: one vector less in an event [rad]
   real(wp), parameter :: least_turn = 0.01_wp

   !> Stiffness along a rotating crack over that across it, at most; not where it is pressed by more than its strength
   real(wp), parameter :: most_contrast = 10.0_wp

   type, abstract, extends(plane_history) :: plane_damage
   contains
      procedure :: damage => damage_point
      procedure :: report
      procedure :: state
   end type plane_damage

contains

   !> One tooth, closing or opening of a point, and the vectors by which the stiffness changes
   pure subroutine damage_point(group, point, code, lambda, ua, ub, event, tooth)
      class(plane_damage), intent(inout) :: group
      integer, intent(in) :: point
      integer, intent(in) :: code
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      type(event_vectors), intent(out) :: event
      integer, intent(out) :: tooth
      real(wp), parameter :: right_angle = 0.5_wp * acos(-1.0_wp)
      real(wp) :: la(most_entries), lb(most_entries), eps(3, most_per), s(3), v(3), old(4), phi, delta, pressed
      real(wp) :: before, after, alpha, change, sound, reached
      logical :: turns, follows
      integer :: e, j, k, p, sense

      p = point
      e = (p - 1) / group%per + 1
      k = 1 + mod(code - 1, 2)
      sense = code - k + 1
      turns = sense == code_tension .and. group%options%cracking == rotating .and. group%axis(e) == axis_free
      call group%gather(e, ua, la)
      call group%gather(e, ub, lb)
      la(1:group%freedoms) = la(1:group%freedoms) + lambda * lb(1:group%freedoms)
      call group%strains(e, la, eps)
      j = p - (e - 1) * group%per
      delta = 0.0_wp
      if (group%cracked(p) == 0) then
         s = stress_at(group, p, in_crack_axes(group, p, eps(:, j)))
         if (is_bedded(group, e)) then
            call open_bedded(group, e, p, s, sense == code_tension)
         else
            phi = 0.5_wp * atan2(2.0_wp * s(3), s(1) - s(2))     ! thesis Eq. 4.7
            group%turn(:, p) = [cos(phi), sin(phi)]
            group%cracked(p) = 1
         end if
         call set_band(group, e, p)
      else if (turns) then
         s = in_crack_axes(group, p, eps(:, j))
         delta = 0.5_wp * atan2(s(3), s(1) - s(2))
         delta = delta - right_angle * anint(delta / right_angle)   ! to the nearer of both principal directions
         if (abs(delta) < least_turn) delta = 0.0_wp
      end if
      old = group%stiff(:, p)
      before = direction_modulus(group, e, p, k)
      if (delta /= 0.0_wp) then
         group%turn(:, p) = [cos(delta) * group%turn(1, p) - sin(delta) * group%turn(2, p), &
            sin(delta) * group%turn(1, p) + cos(delta) * group%turn(2, p)]
         call set_band(group, e, p)
         call group%refresh(p)
      end if
      sound = direction_modulus(group, e, p, k)
      s = stress_at(group, p, in_crack_axes(group, p, eps(:, j)))
      reached = abs(s(k))
      select case (sense)
      case (code_tension)
         ! What no load relieves is beyond its strength
         reached = min(reached, group%teeth%strength_of(group%table_of(e, p, k), group%tooth(k, p), &
            share_of(group, e, p, k)))
         group%tooth(k, p) = group%tooth(k, p) + 1_c_int
      case (code_compression)
         group%crush(k, p) = group%crush(k, p) + 1_c_int
      case (code_close)
         group%shut(k, p) = 1
         group%changes(k, p) = group%changes(k, p) + 1_c_int
      case default
         group%shut(k, p) = 0
         group%changes(k, p) = group%changes(k, p) + 1_c_int
      end select
      tooth = int(merge(group%crush(k, p), group%tooth(k, p), sense == code_compression))
      if (group%options%cracking == isotropic) then
         group%tooth(2, p) = group%tooth(1, p)
         group%crush(1, p) = maxval(group%crush(:, p))
         group%crush(2, p) = group%crush(1, p)
      end if
      follows = .false.
      if (turns) then
         call group%refresh(p)
         s = stress_at(group, p, in_crack_axes(group, p, eps(:, j)))
         pressed = 0.0_wp
         if (.not. group%options%closure) pressed = &
            group%teeth%strength_of(group%table_of(e, p, 3 - k), 1_c_int, share_of(group, e, p, 3 - k))
         if (s(3 - k) > -pressed) call follow_crack(group, e, p, k, follows)
      end if
      after = direction_modulus(group, e, p, k)
      call group%refresh(p)
      ! The area of the tooth: between the secants before and after, up to the stress reached
      event%cracks = .false.
      if (sense == code_tension .or. sense == code_compression) event%crack = &
         0.5_wp * max(sound - after, 0.0_wp) * (reached / sound)**2 * group%weight(p)

      if (group%options%cracking == isotropic) then
         ! All of D changes in proportion: the Cholesky factor of the change, three vectors.
         change = (1.0_wp - after / before) * group%weight(p)
         v = [sqrt(old(1)), old(2) / sqrt(old(1)), 0.0_wp]
         call add_vector(group, e, p, v, change, event)
         call add_vector(group, e, p, [0.0_wp, sqrt(old(3) - v(2)**2), 0.0_wp], change, event)
         call add_vector(group, e, p, [0.0_wp, 0.0_wp, sqrt(old(4))], change, event)
      else if (delta /= 0.0_wp .or. follows) then
         call add_change(group, e, p, old, delta, event)
      else
         if (before /= after) then
            alpha = 1.0_wp / (1.0_wp / (1.0_wp / after - 1.0_wp / before) + merge(old(1), old(3), k == 1))
            v = [merge(old(1), old(2), k == 1), merge(old(2), old(3), k == 1), 0.0_wp]
            call add_vector(group, e, p, v, alpha * group%weight(p), event)
         end if
         change = old(4) - group%stiff(4, p)
         if (abs(change) > 1.0e-14_wp * old(4)) then
            call add_vector(group, e, p, [0.0_wp, 0.0_wp, 1.0_wp], change * group%weight(p), event)
         end if
      end if

   end subroutine damage_point

   !> Teeth of the other direction, so that it is not much stiffer than that of crack k
   pure subroutine follow_crack(group, e, p, k, follows)
      class(plane_damage), intent(inout) :: group
      integer, intent(in) :: e
      integer, intent(in) :: p
      integer, intent(in) :: k
      logical, intent(out) :: follows      !! the other direction has lost teeth
      real(wp) :: most
      integer :: other
      other = 3 - k
      most = most_contrast * direction_modulus(group, e, p, k)
      follows = .false.
      do while (group%tooth(other, p) < group%tooth(k, p))
         if (direction_modulus(group, e, p, other) <= most) exit
         group%tooth(other, p) = group%tooth(other, p) + 1_c_int
         follows = .true.
      end do
   end subroutine follow_crack

   !> The vectors of a change of the stiffness and of the axes, up to three, some of which may stiffen
   pure subroutine add_change(group, e, p, old, delta, event)
      class(plane_damage), intent(in) :: group
      integer, intent(in) :: e
      integer, intent(in) :: p
      real(wp), intent(in) :: old(4)       !! stiffness in the old axes [Pa]
      real(wp), intent(in) :: delta        !! angle from the old axes to the new ones [rad]
      type(event_vectors), intent(inout) :: event
      real(wp) :: c, s, r(3, 3), d(3, 3), vectors(3, 3), least
      integer :: i

      c = cos(delta)
      s = -sin(delta)
      r(1, :) = [c**2, s**2, c * s]
      r(2, :) = [s**2, c**2, -c * s]
      r(3, :) = [-2.0_wp * c * s, 2.0_wp * c * s, c**2 - s**2]
      d = stiffness_matrix(old)
      d = matmul(d, r)
      d = matmul(transpose(r), d)
      d = d - stiffness_matrix(group%stiff(:, p))
      call principal(d, vectors)
      least = 1.0e-14_wp * maxval(old)
      do i = 1, 3    ! stiffening first: the small system of the event then has no small pivot, see sla_events
         if (d(i, i) < -least) call add_vector(group, e, p, vectors(:, i), d(i, i) * group%weight(p), event)
      end do
      do i = 1, 3
         if (d(i, i) > least) call add_vector(group, e, p, vectors(:, i), d(i, i) * group%weight(p), event)
      end do
   end subroutine add_change

   !> Dnn, Dns, Dss, G as a matrix
   pure function stiffness_matrix(stiff) result(d)
      real(wp), intent(in) :: stiff(4)
      real(wp) :: d(3, 3)
      d = 0.0_wp
      d(1:2, 1) = stiff(1:2)
      d(1:2, 2) = stiff(2:3)
      d(3, 3) = stiff(4)
   end function stiffness_matrix

   !> One more vector sqrt(|size|) B' R' v, softening where size > 0
   pure subroutine add_vector(group, e, p, v, size, event)
      class(plane_damage), intent(in) :: group
      integer, intent(in) :: e
      integer, intent(in) :: p
      real(wp), intent(in) :: v(3)           !! stress in the crack axes
      real(wp), intent(in) :: size
      type(event_vectors), intent(inout) :: event
      real(wp) :: local(most_entries)
      event%rank = event%rank + 1
      event%sign(event%rank) = sign(1.0_wp, size)
      call group%nodal(e, p, in_element_axes(group, p, sqrt(abs(size)) * v), local)
      call group%spread(e, local, event, event%rank)
   end subroutine add_vector

   pure subroutine state(group, store, values)
      class(plane_damage), intent(inout) :: group
      logical, intent(in) :: store
      real(wp), intent(inout) :: values(:, :)
      integer :: e, p
      if (store) then
         values(1:2, :) = group%turn
         values(3, :) = real(group%cracked, wp)
         values(4:5, :) = real(group%tooth, wp)
         values(6:7, :) = real(group%crush, wp)
         values(8:9, :) = real(group%shut, wp)
         values(10:11, :) = real(group%changes, wp)
      else
         group%turn(:, :) = values(1:2, :)
         group%cracked(:) = nint(values(3, :), c_int)
         group%tooth(:, :) = nint(values(4:5, :), c_int)
         group%crush(:, :) = nint(values(6:7, :), c_int)
         group%shut(:, :) = nint(values(8:9, :), c_int)
         group%changes(:, :) = nint(values(10:11, :), c_int)
         do p = 1, group%points
            e = (p - 1) / group%per + 1
            if (is_bedded(group, e) .and. group%cracked(p) > 0) call set_pair(group, e, p)
            call group%refresh(p)
         end do
      end if
   end subroutine state

   !> Rows: 1-3 strain and 4-6 stress in the crack axes, 7-8 cosine and sine of the first crack's normal,
   !> 9-10 moduli over the initial one, 11-12 tension teeth, 13-14 admitted range of lambda, 15 volume,
   !> 16-17 compression teeth, 18 shut (1 first, 2 second direction, 3 both),
   !> 19 crack band [m]
   pure subroutine report(group, ua, ub, lambda, noise, values)
      class(plane_damage), intent(in) :: group
      real(wp), intent(in) :: ua(0:)
      real(wp), intent(in) :: ub(0:)
      real(wp), intent(in) :: lambda
      real(wp), intent(in) :: noise
      real(wp), intent(out) :: values(:, :)     !! (report_rows, points)
      real(wp) :: la(most_entries), lb(most_entries), all_a(3, most_per), all_b(3, most_per), ea(3), eb(3)
      type(scan_result) :: found
      integer :: e, p, k

      do e = 1, group%elements
         call group%gather(e, ua, la)
         call group%gather(e, ub, lb)
         call group%strains(e, la, all_a)
         call group%strains(e, lb, all_b)
         do p = (e - 1) * group%per + 1, e * group%per
            ea = in_crack_axes(group, p, all_a(:, p - (e - 1) * group%per))
            eb = in_crack_axes(group, p, all_b(:, p - (e - 1) * group%per))
            values(1:3, p) = ea + lambda * eb
            values(4:6, p) = stress_at(group, p, ea + lambda * eb)
            values(7:8, p) = group%turn(:, p)
            values(9, p) = direction_modulus(group, e, p, 1) / group%young(e)
            k = merge(1, 2, group%options%cracking == isotropic)
            values(10, p) = direction_modulus(group, e, p, k) / group%young(e)
            values(11:12, p) = real(group%tooth(:, p), wp)
            found = scan_result()
            call scan_point(group, e, p, stress_at(group, p, ea), stress_at(group, p, eb), lambda, noise, found)
            values(13:14, p) = admitted(found)
            values(15, p) = group%weight(p)
            values(16:17, p) = real(group%crush(:, p), wp)
            values(18, p) = real(group%shut(1, p) + 2 * group%shut(2, p), wp)
            values(19, p) = 0.0_wp
            if (group%table(e) /= 0) values(19, p) = group%teeth%band(group%table_of(e, p, 1))
            if (is_bedded(group, e) .and. group%cracked(p) > 0) values(19, p) = &
               width_across(group, e, group%turn(:, p))
         end do
      end do
   end subroutine report

end module sla_plane_damage
